// mien evaluate takes: several takes of every sequence against the truth, by ProbTalk3D's definitions.
#include "evaluate_takes.h"

#include <memory>
#include <numeric>
#include <optional>

#include "character_source.h"
#include "metric_row.h"
#include "mien/base/file.h"
#include "mien/base/parallel.h"
#include "mien/base/random.h"
#include "mien/core/flame_parameters.h"
#include "mien/datasets/sequence_pairs.h"
#include "mien/face/flame.h"
#include "mien/face/regions.h"
#include "mien/face/vertex_sequence.h"
#include "mien/io/character_file.h"
#include "mien/io/flame_file.h"
#include "mien/io/mesh_file.h"
#include "mien/io/motion_file.h"
#include "mien/metrics/report.h"
#include "mien/metrics/surface_distance.h"
#include "mien/metrics/take_error.h"
#include "mien/metrics/vertex_error.h"
#include "options.h"
#include "printing.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
// What ProbTalk3D models of a face, and so compares: the first expressions and the jaw, without a shape.
constexpr std::size_t kNumCompared = 50;

constexpr std::string_view kOwnCharacter = "default";
constexpr float kMillimetres = 1000;  // of a character, which is in metres

struct TakeArguments {
  std::string predicted, truth, flame, character, mouth, upper;
  std::uint64_t seed = 1234;  // as the authors' program
  int threads = hardware_threads();
  bool per_sequence = false, surface = false;
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

// What makes vertices of parameters and coefficients, where there is such.
struct Faces {
  std::optional<FlameModel> flame;
  std::optional<FlamePoser> poser;
  std::optional<Character> character;

  /// Of the surface. Error (Errc::usage): neither is there.
  [[nodiscard]] Result<std::vector<TriangleTree::Triangle>> triangles() const {
    if (character) return merged_mesh(*character).triangles;
    if (flame) return flame_mesh(*flame).triangles;
    return Error{Errc::usage, "--surface", "needs the triangles of the face", "Pass --character or --flame"};
  }
  /// The face at rest with so many vertices; empty: unknown.
  [[nodiscard]] std::vector<float> neutral(std::int64_t num_vertices) const {
    if (flame && flame->num_vertices == num_vertices) return flame->neutral;
    std::vector<float> rest;
    if (character)
      for (const Vec3& p : merged_mesh(*character).positions)
        rest.insert(rest.end(), {p.x * kMillimetres, p.y * kMillimetres, p.z * kMillimetres});
    if (static_cast<std::int64_t>(rest.size()) != 3 * num_vertices) rest.clear();
    return rest;
  }
};

Result<Faces> load_faces(const TakeArguments& a, ConsoleProgress& progress) {
  Faces faces;
  if (!a.flame.empty()) {
    MIEN_TRY(faces.flame, read_flame_model(a.flame));
    faces.poser.emplace(*faces.flame);
  }
  if (!a.character.empty()) {
    MIEN_TRY(const fs::path path, character_path(a.character == kOwnCharacter ? "" : a.character));
    auto character = load_character(path);
    if (!character) return character.error();
    for (const auto& warning : character.warnings) progress.warn(warning);
    faces.character = std::move(*character);
  }
  return faces;
}

// The expression of a motion of coefficients: a turned head is no error of the face.
Motion without_head(const Motion& motion) {
  Motion face{motion.space, {}, motion.fps, {}};
  std::vector<std::size_t> kept;
  for (std::size_t c = 0; c < motion.channels.size(); ++c)
    if (!motion.channels[c].starts_with("head"))
      kept.push_back(c), face.channels.push_back(motion.channels[c]);
  for (std::int64_t n = 0; n < motion.num_frames(); ++n)
    for (const std::size_t c : kept) face.values.push_back(motion.frame(n)[c]);
  return face;
}

class SequenceReader {
 public:
  SequenceReader(const Faces& faces, int threads) : faces_(faces), threads_(threads) {}
  /// A file of vertices as it is, one of FLAME parameters through the model, one of coefficients through the
  /// character.
  [[nodiscard]] Result<Motion> read(const fs::path& path) const {
    auto motion = read_motion(path, {.fps = 25});
    if (!motion) return motion.error();
    const bool is_other = motion->space == MotionSpace::vertices || motion->space == MotionSpace::flame;
    if (is_other && faces_.character)  // they are not in its millimetres
      return Error{Errc::usage, "--character",
                   "is for files of coefficients, which '" + path.string() + "' is not", "Leave it out"};
    if (motion->space == MotionSpace::vertices) return std::move(*motion);
    if (motion->space != MotionSpace::flame) {
      if (!faces_.character)
        return Error{Errc::usage, "'" + path.string() + "'", "holds coefficients, which need a character",
                     "Pass --character default, or a face of your own"};
      MIEN_TRY(Motion vertices, vertex_sequence(*faces_.character, without_head(*motion), threads_));
      for (float& v : vertices.values) v *= kMillimetres;
      return vertices;
    }
    if (!faces_.poser)
      return Error{Errc::usage, "'" + path.string() + "'", "holds FLAME parameters, which need a FLAME model",
                   "Pass --flame generic_model.pkl"};
    return flame_vertices(*faces_.poser, compared_parameters(*motion), threads_);
  }

 private:
  const Faces& faces_;
  int threads_;
};

// The region of a file, or that of the character; empty: neither.
Result<std::vector<std::uint32_t>> region_of(const std::string& path, const Faces& faces,
                                             std::string_view name, std::int64_t num_vertices,
                                             double weight_above) {
  if (path.empty()) {
    std::vector<std::uint32_t> region;
    if (!faces.character) return region;
    if (const auto found = find_region(*faces.character, name)) region.assign(found->begin(), found->end());
    return region;
  }
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
                 "less that of |p - t|^2; t the FLAME model or the character at rest, first take, signed"));
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
  MIEN_TRY(const Faces faces, load_faces(a, progress));
  const SequenceReader reader(faces, a.threads);
  MIEN_TRY(const auto triangles, a.surface ? faces.triangles() : std::vector<TriangleTree::Triangle>());
  std::optional<VertexErrors> first;
  std::optional<TakeErrors> all;
  std::vector<float> neutral;
  bool has_regions = false;
  double distance_sum = 0;
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
      MIEN_TRY(auto mouth, region_of(a.mouth, faces, kLipsRegion, count, kMouthWeightAbove));
      MIEN_TRY(auto upper, region_of(a.upper, faces, kUpperFaceRegion, count, kUpperWeightAbove));
      has_regions = !mouth.empty() && !upper.empty();
      neutral = faces.neutral(count);
      first.emplace(VertexRegions{mouth, std::move(upper)});
      all.emplace(std::move(mouth));
    }
    MIEN_TRY([[maybe_unused]] const auto one, first->add(sequence.sequence, truth, takes.front(), neutral));
    MIEN_TRY([[maybe_unused]] const auto more,
             all->add(sequence.sequence, truth, takes, shuffled(takes.size(), rng)));
    if (a.surface) {
      MIEN_TRY(const double distance, surface_distance(truth, takes.front(), triangles, a.threads));
      distance_sum += distance;
    }
    progress.update(++done);
  }
  MetricTable table{"Takes: " + std::to_string(paired.sequences.size()) + " sequences, " +
                        std::to_string(first->num_frames()) + " frames; " +
                        (a.character.empty() ? "units of the data" : "millimetres"),
                    {"value"},
                    {},
                    {}};
  add_rows(*first, *all, table);
  if (a.surface)
    table.rows.push_back(metric_row("surface distance",
                                    distance_sum / static_cast<double>(paired.sequences.size()),
                                    "mean over vertices, frames and sequences, in this order, of the "
                                    "distance from the predicted vertex to "
                                    "the true surface, first take (FaceXHuBERT's mean face vertex error)"));
  if (a.per_sequence)
    for (const TakeError& e : all->sequences()) {
      table.rows.push_back(metric_row("MEE " + e.name, e.mee, "of this sequence"));
      table.rows.push_back(metric_row("CE " + e.name, e.ce, "of this sequence"));
      table.rows.push_back(metric_row("Diversity " + e.name, e.diversity, "of this sequence"));
    }
  if (!has_regions)
    table.notes.emplace_back(
        "LVE, MEE and CE need --mouth, FDD needs --upper and --flame, or --character with these regions");
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
  command->add_option(
      "--character", a->character,
      "Face for files of coefficients, without the turning of the head: 'default' for Mien's "
      "head, else a file (.glb .gltf .vrm .safetensors). Its regions serve where none is named");
  command->add_option("--mouth", a->mouth, "Region file of the lips");
  command->add_option("--upper", a->upper, "Region file of the upper face");
  command->add_flag("--surface", a->surface,
                    "Also FaceXHuBERT's distance to the true surface, which takes some 40 ms a frame");
  command->add_option("--seed", a->seed, "Decides which takes are paired for the diversity")
      ->capture_default_str();
  command->add_flag("--per-sequence", a->per_sequence, "Also print every sequence");
  add_table_options(*command, a->form, chosen);
  add_threads_option(*command, a->threads);
  add_footer(*command,
             "  mien evaluate takes result 3DMEAD/param --flame generic_model.pkl --mouth lve.txt --upper "
             "fdd.txt\n"
             "  mien evaluate takes kept/takes kept/truth --character default\n");
  command->callback([a, &chosen] {
    a->form.json = chosen.json;
    chosen.work = [a](ConsoleProgress& progress) { return run(*a, progress); };
  });
}

}  // namespace mien
