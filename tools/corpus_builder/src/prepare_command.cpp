#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <memory>

#include "commands.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "mien/console/console_exit.h"
#include "prepare.h"
#include "set_check.h"

namespace mien {
namespace {

struct Arguments {
  PrepareSetOptions options;
  std::string output;
  bool quiet = false;
};

int prepare(const Arguments& a) {
  const auto started = std::chrono::steady_clock::now();
  ConsoleProgress progress(a.quiet ? ConsoleMode::quiet : ConsoleMode::text);
  cancel_on_interrupt(progress);
  const auto done = prepare_set(a.output, a.options, progress);
  if (!done.has_value()) return report_error(done.error(), progress);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  std::fprintf(stderr,
               "wrote %s: %lld items, %s h distinct, %lld entries, %s h, %lld skipped, seed %llu, in %s s\n",
               a.output.c_str(), static_cast<long long>(done->items), fixed(done->distinct_hours, 2).c_str(),
               static_cast<long long>(done->entries), fixed(done->hours, 2).c_str(),
               static_cast<long long>(done->skipped), static_cast<unsigned long long>(a.options.plan.seed),
               fixed(seconds, 1).c_str());
  return 0;
}

int check(const std::string& path) {
  const auto statistics = check_set(path);
  if (!statistics.has_value()) {
    ConsoleProgress progress(ConsoleMode::text);
    return report_error(statistics.error(), progress);
  }
  std::fputs(to_text(*statistics).c_str(), stdout);
  return 0;
}

}  // namespace

Command add_prepare_command(CLI::App& app) {
  const auto a = std::make_shared<Arguments>();
  a->options.jobs = hardware_threads();
  auto* c =
      app.add_subcommand("prepare", "Write a prepared training set for mien-train (one safetensors file).");
  c->add_option("-o,--output", a->output, "file to write")->required();
  c->add_option("--hours", a->options.plan.hours, "hours of distinct speech")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
  c->add_option("--seed", a->options.plan.seed, "the same seed gives the same file")->capture_default_str();
  c->add_option("--copies", a->options.copies, "differently worsened copies of every item")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  c->add_option("--takes", a->options.takes, "performances per copy, each in a random training style")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  c->add_option("--valid-share", a->options.plan.valid_share,
                "share of items with sentences kept for validation")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  c->add_option("-j,--jobs", a->options.jobs, "processes at once; the result does not depend on it")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  c->add_flag("-q,--quiet", a->quiet, "no progress");
  c->footer(
      "Examples:\n"
      "  mien-corpus prepare -o set.safetensors --hours 9.5 --copies 2 --takes 3 -j 4\n"
      "  mien-corpus prepare -o small.safetensors --hours 0.2 --copies 1 --takes 2 --seed 7");
  return [a] { return prepare(*a); };
}

Command add_check_command(CLI::App& app) {
  const auto path = std::make_shared<std::string>();
  auto* c = app.add_subcommand("check", "Verify a prepared training set and print what it holds.");
  c->add_option("set", *path, "file written by mien-corpus prepare")->required();
  c->footer("Example:\n  mien-corpus check set.safetensors");
  return [path] { return check(*path); };
}

}  // namespace mien
