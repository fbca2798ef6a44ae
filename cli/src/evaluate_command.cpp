// mien evaluate: the measures of docs/quality.md, on people and on a stored corpus.

#include "director.h"
#include "evaluate_coefficients.h"
#include "evaluate_sequences.h"
#include "evaluate_takes.h"
#include "mien/audio/load_audio.h"
#include "mien/base/parallel.h"
#include "mien/console/console_exit.h"
#include "mien/metrics/human_report.h"
#include "mien/metrics/synthetic_benchmark.h"
#include "mien/models/animate.h"
#include "options.h"
#include "printing.h"
#include "share.h"

namespace mien {
namespace {

struct EvaluateArguments {
  std::string folder, model;
  DirectionWords words;
  int takes = 8, draws = kDefaultDraws;
  std::vector<std::string> only, splits;
  std::int64_t max_items = 0;
  int true_takes = 32;
  TableForm form;
  int threads = hardware_threads();
};

Result<DefaultModel> load_model(const EvaluateArguments& a) {
  if (!a.model.empty()) return DefaultModel::load(a.model);
  MIEN_TRY(const auto path, shared_file("default.safetensors", "--model FILE"));
  return DefaultModel::load(path);
}

// One performance per seed of one recording.
Result<std::vector<Motion>> perform(const DefaultModel& model, const AudioClip& clip, PerformOptions options,
                                    std::span<const std::uint64_t> seeds, int threads) {
  std::vector<std::optional<Result<Motion>>> takes(seeds.size());
  parallel_for(threads, static_cast<std::int64_t>(seeds.size()), [&](std::int64_t k) {
    Progress unseen;
    PerformOptions own = options;
    own.seed = seeds[static_cast<std::size_t>(k)];
    takes[static_cast<std::size_t>(k)].emplace(animate(model, clip, own, unseen));
  });
  std::vector<Motion> motions;
  for (auto& take : takes) {
    if (!*take) return take->error();
    motions.push_back(std::move(**take));
  }
  return motions;
}

Status evaluate_people(const EvaluateArguments& a, ConsoleProgress& progress) {
  MIEN_TRY(const PerformOptions options, perform_options(a.words));
  MIEN_TRY(const DefaultModel model, load_model(a));
  HumanEvaluation evaluation;
  evaluation.load = [](const std::filesystem::path& path) { return load_audio(path); };
  evaluation.only = a.only;
  std::vector<std::uint64_t> seeds;
  for (int take = 0; take < a.takes; ++take) seeds.push_back(performance_seed(a.words.seed, take));
  evaluation.generate = [&](std::string_view, std::span<const float> samples) {
    return perform(model, AudioClip{{samples.begin(), samples.end()}}, options, seeds, a.threads);
  };
  const auto report = evaluate_human(a.folder, evaluation, progress);
  if (!report) return report.error();
  return print(human_table(*report, a.draws), a.form, false);
}

Status evaluate_corpus(const EvaluateArguments& a, ConsoleProgress& progress) {
  MIEN_TRY(const PerformOptions options, perform_options(a.words));
  MIEN_TRY(const DefaultModel model, load_model(a));
  const SyntheticSystem system = [&](const SyntheticRequest& request) -> Result<std::vector<Motion>> {
    MIEN_TRY(const AudioClip clip, load_audio(request.audio));
    DirectionKey key;
    if (request.item.emotion != Emotion::neutral)
      key.intensities[static_cast<std::size_t>(request.item.emotion)] = request.item.intensity();
    if (const auto style = parse_style(request.item.speaker))
      key.style = *style;  // else one never seen in training
    PerformOptions own = options;
    own.direction = Direction({key});
    return perform(model, clip, own, request.take_seeds, a.threads);
  };
  SyntheticOptions how;
  how.samples = a.takes;
  how.true_takes = a.true_takes;
  how.seed = a.words.seed;
  how.threads = a.threads;
  how.splits = a.splits;
  how.max_items = a.max_items;
  auto report = evaluate_synthetic(a.folder, system, how, progress);
  if (!report) return report.error();
  const std::string name = std::filesystem::weakly_canonical(a.folder).filename().string();
  const std::vector<NamedSyntheticReport> sets = {{name, std::move(*report)}};
  return print(synthetic_table(sets, a.draws), a.form, false);
}

std::shared_ptr<EvaluateArguments> add_common(CLI::App& command, Chosen& chosen) {
  auto a = std::make_shared<EvaluateArguments>();
  command.add_option("FOLDER", a->folder, "Folder of the benchmark")->required();
  command.add_option("--model", a->model, "Model file (.safetensors). Default: the one that comes with Mien");
  command.add_option("--seed", a->words.seed, "Seed of the first take")->capture_default_str();
  command.add_option("--steps", a->words.steps, "Diffusion steps, 1 to 1000")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--sampler", a->words.sampler, "dpm++, ddim or ddpm")->capture_default_str();
  command
      .add_option("--draws", a->draws, "Bootstrap draws for the 95 % intervals, 0 to 100000; 0: no intervals")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  add_table_options(command, a->form, chosen);
  add_threads_option(command, a->threads);
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
  add_footer(*corpus, "  mien evaluate corpus build/corpus/test --max-items 40\n");

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
