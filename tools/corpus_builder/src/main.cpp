// mien-corpus: makes synthetic speech with exact phone times, and from it training and test sets.
// docs/corpus.md.
#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>

#include "console_progress.h"
#include "engine.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "plan.h"
#include "prepare.h"
#include "set_check.h"

namespace {

using namespace mien;

ConsoleProgress* running = nullptr;
void interrupt(int) {
  if (running != nullptr) running->cancel();
}

int exit_code(const Error& error) {
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

int list() {
  std::vector<std::string> missing;
  for (const auto* engine : available_engines(&missing)) {
    std::printf("%s (%s)\n ", std::string(engine_name(engine->id())).c_str(), engine->version().c_str());
    for (const auto& voice : engine->voices()) std::printf(" %s", voice.c_str());
    std::printf("\n");
  }
  for (const auto& line : missing) std::printf("absent: %s\n", line.c_str());
  const auto print = [](const char* title, const std::vector<std::string>& names) {
    std::printf("%s:", title);
    for (const auto& name : names) std::printf(" %s", name.c_str());
    std::printf("\n");
  };
  print("espeak variants for training", training_variants());
  print("espeak variants for tests only", held_out_variants());
  return 0;
}

struct PrepareArguments {
  PrepareOptions options;
  std::string output;
};

void add_prepare(CLI::App& app, PrepareArguments& a, bool& quiet) {
  auto* c =
      app.add_subcommand("prepare", "Write a prepared training set for mien-train (one safetensors file).");
  c->add_option("-o,--output", a.output, "file to write")->required();
  c->add_option("--hours", a.options.plan.hours, "hours of distinct speech")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
  c->add_option("--seed", a.options.plan.seed, "seed; the same seed gives the same file")
      ->capture_default_str();
  c->add_option("--copies", a.options.copies, "differently worsened copies of every item")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  c->add_option("--takes", a.options.takes, "performances per copy, each in a random training style")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  c->add_option("--valid-share", a.options.plan.valid_share,
                "share of items with sentences kept for validation")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  c->add_option("-j,--jobs", a.options.jobs, "processes at once; the result does not depend on it")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  c->add_flag("-q,--quiet", quiet, "no progress");
  c->footer(
      "Examples:\n"
      "  mien-corpus prepare -o set.safetensors --hours 9.5 --copies 2 --takes 3 -j 4\n"
      "  mien-corpus prepare -o small.safetensors --hours 0.2 --copies 1 --takes 2 --seed 7");
}

int check(const std::string& path) {
  const auto statistics = check_set(path);
  if (!statistics.has_value()) return exit_code(statistics.error());
  std::fputs(to_text(*statistics).c_str(), stdout);
  return 0;
}

int prepare(const PrepareArguments& a, bool quiet) {
  const auto started = std::chrono::steady_clock::now();
  ConsoleProgress progress(quiet);
  running = &progress;
  std::signal(SIGINT, interrupt);
  const auto done = prepare_set(a.output, a.options, progress);
  running = nullptr;
  if (!done.has_value()) return exit_code(done.error());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  std::fprintf(stderr,
               "wrote %s: %lld items, %s h distinct, %lld entries, %s h, %lld skipped, seed %llu, in %s s\n",
               a.output.c_str(), static_cast<long long>(done->items), fixed(done->distinct_hours, 2).c_str(),
               static_cast<long long>(done->entries), fixed(done->hours, 2).c_str(),
               static_cast<long long>(done->skipped), static_cast<unsigned long long>(a.options.plan.seed),
               fixed(seconds, 1).c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Makes synthetic speech with exact phone times, and training and test sets of facial animation from "
      "it.");
  app.name("mien-corpus");
  app.require_subcommand(1);
  app.footer("Exit codes: 0 done, 1 failed, 2 wrong usage, 3 input unreadable, 130 interrupted.");
  bool quiet = false;
  PrepareArguments prepare_arguments;
  prepare_arguments.options.jobs = hardware_threads();
  auto* list_command = app.add_subcommand("list", "Print the engines, voices and variants that are present.");
  add_prepare(app, prepare_arguments, quiet);
  std::string checked;
  auto* check_command =
      app.add_subcommand("check", "Verify a prepared training set and print what it holds.");
  check_command->add_option("set", checked, "file written by mien-corpus prepare")->required();
  check_command->footer("Example:\n  mien-corpus check set.safetensors");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    const int code = app.exit(e);
    return code == 0 ? 0 : 2;
  }
  if (list_command->parsed()) return list();
  if (check_command->parsed()) return check(checked);
  return prepare(prepare_arguments, quiet);
}
