// mien evaluate: the measures of docs/quality.md, on people and on a stored corpus.

#include <CLI/CLI.hpp>

#include "benchmark_files.h"
#include "benchmark_performer.h"
#include "corpus_reference.h"
#include "evaluate_coefficients.h"
#include "evaluate_sequences.h"
#include "evaluate_takes.h"
#include "mien/audio/load_audio.h"
#include "mien/console/console_exit.h"
#include "mien/metrics/human_report.h"
#include "mien/metrics/synthetic_benchmark.h"
#include "mien/models/seeds.h"
#include "options.h"
#include "printing.h"

namespace mien {
namespace {

struct EvaluateArguments {
  std::string folder, keep;
  AnimateArguments performer;  ///< the model, its words and the threads
  int takes = 8, draws = kDefaultDraws;
  std::vector<std::string> only, splits;
  std::int64_t max_items = 0;
  int true_takes = 32;
  TableForm form;
};

Status evaluate_people(const EvaluateArguments& a, ConsoleProgress& progress) {
  MIEN_TRY(const auto performer, BenchmarkPerformer::load(a.performer));
  HumanEvaluation evaluation;
  evaluation.load = [](const std::filesystem::path& path) { return load_audio(path); };
  evaluation.only = a.only;
  std::vector<std::uint64_t> seeds;
  for (int take = 0; take < a.takes; ++take) seeds.push_back(performance_seed(a.performer.words.seed, take));
  evaluation.generate = [&](std::string_view, std::span<const float> samples) {
    return performer.perform(AudioClip{{samples.begin(), samples.end()}}, seeds);
  };
  const auto report = evaluate_human(a.folder, evaluation, progress);
  if (!report) return report.error();
  return print(human_table(*report, a.draws), a.form, false);
}

Result<SyntheticSystem> corpus_system(const EvaluateArguments& a) {
  if (is_corpus_reference(a.performer.model)) return corpus_reference(a.performer.model, a.folder);
  MIEN_TRY(auto loaded, BenchmarkPerformer::load(a.performer));
  return SyntheticSystem([performer = std::make_shared<const BenchmarkPerformer>(std::move(loaded))](
                             const SyntheticRequest& request) -> Result<std::vector<Motion>> {
    MIEN_TRY(const AudioClip clip, load_audio(request.audio));
    return performer->perform(request.item, clip, request.take_seeds);
  });
}

Status evaluate_corpus(const EvaluateArguments& a, ConsoleProgress& progress) {
  MIEN_TRY(const SyntheticSystem system, corpus_system(a));
  SyntheticOptions how;
  how.samples = a.takes;
  how.true_takes = a.true_takes;
  how.seed = a.performer.words.seed;
  how.threads = a.performer.threads;
  how.splits = a.splits;
  how.max_items = a.max_items;
  if (!a.keep.empty()) {
    MIEN_TRY(how.keep, benchmark_files(a.keep));
  }
  auto report = evaluate_synthetic(a.folder, system, how, progress);
  if (!report) return report.error();
  const std::string name = std::filesystem::weakly_canonical(a.folder).filename().string();
  const std::vector<NamedSyntheticReport> sets = {{name, std::move(*report)}};
  return print(synthetic_table(sets, a.draws), a.form, false);
}

std::shared_ptr<EvaluateArguments> add_common(CLI::App& command, Chosen& chosen) {
  auto a = std::make_shared<EvaluateArguments>();
  command.add_option("FOLDER", a->folder, "Folder of the benchmark")->required();
  command.add_option(
      "--model", a->performer.model,
      "Model file (.safetensors) of any system that gives ARKit coefficients. Default: the one that comes "
      "with Mien. On a corpus also 'truth' (its generator again: what a perfect model reaches) and 'mean' "
      "(the mean of 32 true takes: what a perfect regression does)");
  command.add_option("--seed", a->performer.words.seed, "Seed of the first take")->capture_default_str();
  add_face_options(command, a->performer.words, a->performer.face);
  add_said_options(command, a->performer.said);
  command
      .add_option("--draws", a->draws, "Bootstrap draws for the 95 % intervals, 0 to 100000; 0: no intervals")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  add_table_options(command, a->form, chosen);
  add_threads_option(command, a->performer.threads);
  return a;
}

}  // namespace

void add_evaluate_command(CLI::App& program, Chosen& chosen) {
  auto* command =
      program.add_subcommand("evaluate", "Measure a model on a benchmark, or sequences against the truth");
  command->require_subcommand(1);
  auto* human = command->add_subcommand("human", "Lips, silence and jaw on recordings of people");
  auto* corpus = command->add_subcommand("corpus", "Everything against redrawn truth on a synthetic corpus");

  add_sequence_evaluations(*command, chosen);
  add_coefficient_evaluation(*command, chosen);
  add_take_evaluation(*command, chosen);

  const auto h = add_common(*human, chosen);
  human->add_option("--takes", h->takes, "Takes of each recording, 1 to 100")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  human->add_option("--only", h->only, "Ids of the recordings to use. Default: all");
  add_footer(*human, "  mien evaluate human ../shared/audio/human --takes 4\n");

  const auto c = add_common(*corpus, chosen);
  corpus->add_option("--takes", c->takes, "Takes of each item, 2 to 100")
      ->check(CLI::Range(2, 100))
      ->capture_default_str();
  corpus->add_option("--true-takes", c->true_takes, "True takes of each item, at least --takes")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  corpus->add_option("--splits", c->splits, "Splits to use. Default: all");
  corpus->add_option("--max-items", c->max_items, "Items, evenly spread; 0: all")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  corpus->add_option("--keep", c->keep,
                     "Folder that gets what was compared: truth/sentenceNN.csv, one take each, "
                     "takes/sentenceNN-1.csv ... and wav/sentenceNN.wav, for the other evaluations");
  add_footer(
      *corpus,
      "  mien evaluate corpus build/corpus/test --max-items 40\n"
      "  mien evaluate corpus test --model facexhubert.safetensors --takes 10 --keep kept\n"
      "  mien evaluate takes kept/takes kept/truth --character default\n"
      "  mien evaluate coefficients kept/takes kept/truth --speech kept/wav --codec said_vae.safetensors\n");

  const auto choose = [&chosen](CLI::App* app, std::shared_ptr<EvaluateArguments> a, auto work) {
    app->callback([&chosen, a, work] {
      a->form.json = chosen.json;
      chosen.work = [a, work](ConsoleProgress& progress) { return work(*a, progress); };
    });
  };
  choose(human, h, &evaluate_people);
  choose(corpus, c, &evaluate_corpus);
}

}  // namespace mien
