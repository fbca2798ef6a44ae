// mien evaluate takes: several takes of every sequence against the truth, by ProbTalk3D's definitions.
#include "evaluate_takes.h"

#include <memory>
#include <numeric>
#include <optional>

#include "metric_row.h"
#include "mien/base/file.h"
#include "mien/base/parallel.h"
#include "mien/base/random.h"
#include "mien/core/flame_parameters.h"
#include "mien/datasets/sequence_pairs.h"
#include "mien/face/flame.h"
#include "mien/io/flame_file.h"
#include "mien/io/motion_file.h"
#include "mien/metrics/report.h"
#include "mien/metrics/take_error.h"
#include "mien/metrics/vertex_error.h"
#include "options.h"
#include "printing.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
// What ProbTalk3D models of a face, and so compares: the first expressions and the jaw, without a shape.
constexpr std::size_t kNumCompared = 50;

struct TakeArguments {
  std::string predicted, truth, flame, mouth, upper;
  std::uint64_t seed = 1234;  // as the authors' program
  int threads = hardware_threads();
  bool per_sequence = false;
  TableForm form;
};

// The parameters that are compared; all others are left at 0.
Motion compared_parameters(const Motion& motion) {
  Motion kept{MotionSpace::flame, flame_channels(0, kNumCompared), motion.fps, {}};
  std::vector<std::optional<std::int64_t>> from;
  for (const auto& channel : kept.channels) from.push_back(motion.find(channel));
  for (std::int64_t n = 0; n < motion.num_frames(); ++n)
    for (const auto& channel : from)
      kept.values.push_back(channel ? motion.frame(n)[static_cast<std::size_t>(*channel)] : 0.0f);
  return kept;
}

class SequenceReader {
 public:
  SequenceReader(const FlamePoser* poser, int threads) : poser_(poser), threads_(threads) {}
  /// A file of vertices as it is, one of FLAME parameters through the model.
  [[nodiscard]] Result<Motion> read(const fs::path& path) const {
    auto motion = read_motion(path, {.fps = 25});
    if (!motion) return motion.error();
    if (motion->space == MotionSpace::vertices) return std::move(*motion);
    if (motion->space != MotionSpace::flame)
      return Error{Errc::incompatible, "'" + path.string() + "'",
                   "holds neither vertices nor FLAME parameters", ""};
    if (poser_ == nullptr)
      return Error{Errc::usage, "'" + path.string() + "'", "holds FLAME parameters, which need a FLAME model",
                   "Pass --flame generic_model.pkl"};
    return flame_vertices(*poser_, compared_parameters(*motion), threads_);
  }

 private:
  const FlamePoser* poser_;
  int threads_;
};

Result<std::vector<std::uint32_t>> read_region_file(const std::string& path, std::int64_t num_vertices,
                                                    double weight_above) {
  if (path.empty()) return std::vector<std::uint32_t>();
  MIEN_TRY(const Bytes bytes, read_file(path));
  auto region = read_region(as_text(bytes), num_vertices, weight_above);
  if (!region) return within(region.error(), "'" + path + "'");
  return region;
}

// 0 ... count - 1 in an order that seed and sequence decide.
std::vector<std::size_t> shuffled(std::size_t count, Rng& rng) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[rng.below(i)]);
  return order;
}

void add_rows(const VertexErrors& first, const TakeErrors& all, MetricTable& table) {
  table.rows.push_back(
      metric_row("MVE", first.mve(), "mean distance |g - p| over all vertices of all frames, first take"));
  table.rows.push_back(
      metric_row("LVE", first.lve(),
                 "mean over all frames of the largest squared distance of a mouth vertex, first take"));
  table.rows.push_back(
      metric_row("FDD", first.fdd(),
                 "mean over sequences of: mean over upper-face vertices of std over frames of |g - t|^2, "
                 "less that of |p - t|^2; t the FLAME model at rest, first take, signed"));
  table.rows.push_back(metric_row("MEE", all.mee(), "LVE of the mean of all takes"));
  table.rows.push_back(metric_row("CE", all.ce(), "LVE of the take of every sequence that is nearest by it"));
  table.rows.push_back(
      metric_row("Diversity", all.diversity(),
                 "mean over sequences, pairs, frames and vertices of the distance between two takes; takes "
                 "are paired at random, each once"));
}

Status run(const TakeArguments& a, ConsoleProgress& progress) {
  MIEN_TRY(const PairedTakes paired, pair_takes(a.predicted, a.truth));
  for (const auto& [names, what] : {std::pair{&paired.without_truth, "predicted files have no truth"},
                                    {&paired.without_prediction, "true sequences have no prediction"}})
    if (!names->empty())
      progress.warn(std::to_string(names->size()) + " " + what + " and are left out, the first is " +
                    names->front());
  std::optional<FlameModel> flame;
  std::optional<FlamePoser> poser;
  if (!a.flame.empty()) {
    MIEN_TRY(flame, read_flame_model(a.flame));
    poser.emplace(*flame);
  }
  const SequenceReader reader(poser ? &*poser : nullptr, a.threads);
  std::optional<VertexErrors> first;
  std::optional<TakeErrors> all;
  Rng rng(a.seed);
  progress.stage("sequences", static_cast<std::int64_t>(paired.sequences.size()));
  std::int64_t done = 0;
  for (const SequenceTakes& sequence : paired.sequences) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    MIEN_TRY(const Motion truth, reader.read(sequence.truth));
    std::vector<Motion> takes;
    for (const auto& path : sequence.takes) {
      MIEN_TRY(takes.emplace_back(), reader.read(path));
    }
    if (!first) {
      const std::int64_t count = truth.topology.num_vertices;
      MIEN_TRY(auto mouth, read_region_file(a.mouth, count, kMouthWeightAbove));
      MIEN_TRY(auto upper, read_region_file(a.upper, count, kUpperWeightAbove));
      first.emplace(VertexRegions{mouth, std::move(upper)});
      all.emplace(std::move(mouth));
    }
    const auto neutral = flame && flame->num_vertices == truth.topology.num_vertices
                             ? std::span<const float>(flame->neutral)
                             : std::span<const float>();
    MIEN_TRY([[maybe_unused]] const auto one, first->add(sequence.sequence, truth, takes.front(), neutral));
    MIEN_TRY([[maybe_unused]] const auto more,
             all->add(sequence.sequence, truth, takes, shuffled(takes.size(), rng)));
    progress.update(++done);
  }
  MetricTable table{"Takes: " + std::to_string(paired.sequences.size()) + " sequences, " +
                        std::to_string(first->num_frames()) + " frames; units of the data",
                    {"value"},
                    {},
                    {}};
  add_rows(*first, *all, table);
  if (a.per_sequence)
    for (const TakeError& e : all->sequences()) {
      table.rows.push_back(metric_row("MEE " + e.name, e.mee, "of this sequence"));
      table.rows.push_back(metric_row("CE " + e.name, e.ce, "of this sequence"));
      table.rows.push_back(metric_row("Diversity " + e.name, e.diversity, "of this sequence"));
    }
  if (a.mouth.empty() || a.upper.empty())
    table.notes.emplace_back("LVE, MEE and CE need --mouth, FDD needs --upper and --flame");
  return print(table, a.form, true);
}

}  // namespace

void add_take_evaluation(CLI::App& evaluate, Chosen& chosen) {
  auto* command =
      evaluate.add_subcommand("takes", "MVE, LVE, FDD, MEE, CE and diversity of several takes (ProbTalk3D)");
  auto a = std::make_shared<TakeArguments>();
  command
      ->add_option("PREDICTED", a->predicted,
                   "Folder of predictions: <truth>(n).npy or <truth>-n.npy, also with more "
                   "words behind an underscore")
      ->required();
  command->add_option("TRUTH", a->truth, "Folder of true sequences")->required();
  command->add_option("--flame", a->flame, "FLAME model for files of parameters: generic_model.pkl or .npz");
  command->add_option("--mouth", a->mouth, "Region file of the lips");
  command->add_option("--upper", a->upper, "Region file of the upper face");
  command->add_option("--seed", a->seed, "Decides which takes are paired for the diversity")
      ->capture_default_str();
  command->add_flag("--per-sequence", a->per_sequence, "Also print every sequence");
  add_table_options(*command, a->form, chosen);
  add_threads_option(*command, a->threads);
  add_footer(*command,
             "  mien evaluate takes result 3DMEAD/param --flame generic_model.pkl --mouth lve.txt --upper "
             "fdd.txt\n");
  command->callback([a, &chosen] {
    a->form.json = chosen.json;
    chosen.work = [a](ConsoleProgress& progress) { return run(*a, progress); };
  });
}

}  // namespace mien
