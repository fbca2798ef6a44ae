#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "build.h"
#include "commands.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "mien/console/console_exit.h"

namespace mien {
namespace {

struct Arguments {
  BuildOptions options;
  std::string output, split = "test-sentence", store = "audio";
  bool quiet = false;
};

int build(Arguments& a) {
  a.options.plan.split = *parse_split(a.split);
  a.options.store = a.store == "items" ? Store::items : a.store == "audio" ? Store::audio : Store::curves;
  ConsoleProgress progress(a.quiet ? ConsoleMode::quiet : ConsoleMode::text);
  cancel_on_interrupt(progress);
  const auto done = build_corpus(a.output, a.options, progress);
  if (!done.has_value()) return report_error(done.error(), progress);
  std::fprintf(stderr, "wrote %s: %lld clips, %s s, %lld skipped, seed %llu\n", a.output.c_str(),
               static_cast<long long>(done->clips), fixed(done->seconds, 1).c_str(),
               static_cast<long long>(done->skipped), static_cast<unsigned long long>(a.options.plan.seed));
  return 0;
}

}  // namespace

Command add_build_command(CLI::App& app) {
  const auto a = std::make_shared<Arguments>();
  a->options.jobs = hardware_threads();
  auto& plan = a->options.plan;
  auto* c =
      app.add_subcommand("build", "Write a corpus folder: sound, exact phones, accents and performances.");
  c->add_option("-o,--output", a->output, "folder to make; must not exist")->required();
  c->add_option("--split", a->split, "part of the corpus")
      ->check(CLI::IsMember(split_names()))
      ->capture_default_str();
  c->add_option("--voice", plan.voices, "only these voices: engine or engine:voice, e.g. espeak flite:slt");
  c->add_option("--clips", plan.clips, "number of clips")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  c->add_option("--clip-seconds", plan.clip_seconds,
                "join sentences to clips of about this length; 0 = one sentence")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  c->add_option("--limit-seconds", a->options.limit_seconds,
                "stop before all clips together get longer; 0 = no limit")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  c->add_option("--emotional-share", plan.emotional_share, "share of clips that are not neutral")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  c->add_flag("--training-styles", plan.training_styles,
              "in test-voice: speakers S00-S11 instead of S12-S15");
  c->add_option("--takes", a->options.takes, "performances stored per clip with --store curves")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  c->add_option("--store", a->store, "items (phones only), audio, or curves (all)")
      ->check(CLI::IsMember({"items", "audio", "curves"}))
      ->capture_default_str();
  c->add_flag("--flac", a->options.flac, "sound as FLAC instead of WAV");
  c->add_option("--reverb", a->options.reverb_rt60_s, "add reverberation of this RT60, seconds")
      ->check(CLI::Range(0.05, 5.0));
  c->add_option("--noise", a->options.noise_snr_db, "add white noise at this signal-to-noise ratio, dB")
      ->check(CLI::Range(-20.0, 80.0));
  c->add_option("--seed", plan.seed, "the same seed gives the same files")->capture_default_str();
  c->add_option("-j,--jobs", a->options.jobs, "processes at once; the result does not depend on it")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  c->add_flag("-q,--quiet", a->quiet, "no progress");
  c->footer(
      "Examples:\n"
      "  mien-corpus build -o eval/slt --split test-voice --voice flite:slt --clips 40\n"
      "  mien-corpus build -o long --split test-engine --clips 4 --clip-seconds 40 --store curves --takes 8");
  return [a] { return build(*a); };
}

}  // namespace mien
