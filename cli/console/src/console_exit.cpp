#include "mien/console/console_exit.h"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <string>

namespace mien {
namespace {

Progress* interrupted_progress = nullptr;

extern "C" void on_interrupt(int) {
  if (interrupted_progress->cancelled()) ::_exit(130);
  interrupted_progress->cancel();
}

}  // namespace

int exit_code(Errc code) {
  switch (code) {
    case Errc::failed:
      return 1;
    case Errc::usage:
      return 2;
    case Errc::input:
      return 3;
    case Errc::incompatible:
      return 4;
    case Errc::cancelled:
      return 130;
  }
  return 1;
}

int report_error(const Error& error, ConsoleProgress& progress, std::string_view event,
                 std::string_view fields) {
  const int code = exit_code(error.code);
  progress.finish_line();
  progress.event(event, std::string(fields) + "\"exit_code\":" + std::to_string(code) +
                            ",\"what\":" + json_string(error.what) + ",\"why\":" + json_string(error.why) +
                            ",\"fix\":" + json_string(error.fix));
  if (progress.mode() != ConsoleMode::json) {
    const std::string what = error.what.empty() ? "" : error.what + ": ";
    std::fprintf(stderr, "error: %s%s\n", what.c_str(), error.why.c_str());
    if (!error.fix.empty()) std::fprintf(stderr, "       %s\n", error.fix.c_str());
  }
  return code;
}

void cancel_on_interrupt(Progress& progress) {
  interrupted_progress = &progress;
  std::signal(SIGINT, &on_interrupt);
  std::signal(SIGTERM, &on_interrupt);
}

std::string json_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
      out += code;
    } else {
      out += c;
    }
  }
  return out + "\"";
}

}  // namespace mien
