#include "command_run.h"

#include <csignal>
#include <cstdio>

namespace mien {
namespace {

Progress* running = nullptr;

void interrupt(int) {
  if (running != nullptr) running->cancel();
}

}  // namespace

int report(const Error& error) {
  std::fprintf(stderr, "mien-corpus: error: %s\n", error.message().c_str());
  switch (error.code) {
    case Errc::usage:
      return 2;
    case Errc::input:
      return 3;
    case Errc::incompatible:
      return 4;
    case Errc::cancelled:
      return 130;
    case Errc::failed:
      break;
  }
  return 1;
}

InterruptibleProgress::InterruptibleProgress(bool quiet) : progress_(quiet) {
  running = &progress_;
  std::signal(SIGINT, interrupt);
}

InterruptibleProgress::~InterruptibleProgress() {
  std::signal(SIGINT, SIG_DFL);
  running = nullptr;
}

}  // namespace mien
