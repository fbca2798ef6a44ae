// mien evaluate vertices | controls: predicted sequences against the true ones, by the papers' definitions.
#include "evaluate_sequences.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>

#include "metric_row.h"
#include "mien/base/file.h"
#include "mien/base/parallel.h"
#include "mien/core/arkit.h"
#include "mien/datasets/dataset.h"
#include "mien/datasets/sequence_pairs.h"
#include "mien/io/mapped_file.h"
#include "mien/io/mesh_file.h"
#include "mien/io/motion_file.h"
#include "mien/io/npy.h"
#include "mien/metrics/control_error.h"
#include "mien/metrics/report.h"
#include "mien/metrics/surface_distance.h"
#include "mien/metrics/vertex_error.h"
#include "options.h"
#include "printing.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

struct SequenceArguments {
  std::string predicted, truth, system, templates, mesh;
  std::vector<std::string> regions;
  int truth_every = 1, threads = hardware_threads();
  bool per_sequence = false;
  TableForm form;
};

// Positions of an array of any number of vertices, every n-th frame.
Result<Motion> read_vertices(const fs::path& path, int every) {
  const std::string name = "'" + path.string() + "'";
  MIEN_TRY(const auto file, MappedFile::open(path));
  auto array = read_npy(file.bytes());
  if (!array) return within(array.error(), name);
  const std::int64_t width = frame_width(array->shape);
  if (width <= 0 || width % 3 != 0)
    return Error{Errc::incompatible, name, "is not an array [frames, 3 vertices]", ""};
  Motion all = vertex_motion(topology_of(width / 3), 25, std::move(array->values));
  if (every == 1) return all;
  Motion kept = vertex_motion(all.topology, all.fps);
  for (std::int64_t n = 0; n < all.num_frames(); n += every)
    kept.values.insert(kept.values.end(), all.frame(n).begin(), all.frame(n).end());
  return kept;
}

bool names_any(std::string text, std::initializer_list<std::string_view> words) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::any_of(words.begin(), words.end(), [&](auto w) { return text.find(w) != std::string::npos; });
}

// "lve.txt", "mouth=lips.txt": which of the two regions a file holds.
Result<VertexRegions> read_regions(const std::vector<std::string>& files, std::int64_t num_vertices) {
  VertexRegions regions;
  for (const auto& named : files) {
    const auto cut = named.find('=');
    const std::string path = cut == std::string::npos ? named : named.substr(cut + 1);
    const std::string role =
        cut == std::string::npos ? fs::path(named).filename().string() : named.substr(0, cut);
    const bool is_mouth = names_any(role, {"mouth", "lve", "lip"}),
               is_upper = names_any(role, {"upper", "fdd", "forehead"});
    if (is_mouth == is_upper)
      return Error{Errc::usage, "--regions '" + named + "'",
                   "does not say whether it is the mouth or the upper face",
                   "Write mouth=FILE or upper=FILE"};
    MIEN_TRY(const Bytes bytes, read_file(path));
    auto region = read_region(as_text(bytes), num_vertices, is_mouth ? kMouthWeightAbove : kUpperWeightAbove);
    if (!region) return within(region.error(), "'" + path + "'");
    (is_mouth ? regions.mouth : regions.upper) = std::move(*region);
  }
  return regions;
}

void tell_unpaired(const PairedSequences& paired, ConsoleProgress& progress) {
  for (const auto& [names, what] : {std::pair{&paired.without_truth, "predicted sequences have no truth"},
                                    {&paired.without_prediction, "true sequences have no prediction"}})
    if (!names->empty())
      progress.warn(std::to_string(names->size()) + " " + what + " and are left out, the first is " +
                    names->front());
}

// FaceDiffuser specification, section 13.
void add_facediffuser_rows(const VertexErrors& errors, double diversity, MetricTable& table) {
  table.rows.push_back(
      metric_row("MVE", errors.mve(),
                 "mean Euclidean distance |g - p| over all vertices of all frames of all sequences "
                 "(FaceDiffuser's program; the thesis says squared)"));
  table.rows.push_back(
      metric_row("LVE", errors.lve(),
                 "mean over all frames of the largest squared distance of a mouth vertex, max |g - "
                 "p|^2 (FaceDiffuser's and CodeTalker's programs)"));
  table.rows.push_back(
      metric_row("FDD", errors.fdd(),
                 "mean over sequences of: mean over upper-face vertices of std over frames of |g - "
                 "t|^2, less that of |p - t|^2; t the subject's template, population std, signed "
                 "(FaceDiffuser's and CodeTalker's programs)"));
  table.rows.push_back(
      metric_row("ABS FDD", errors.absolute_fdd(), "the same with the absolute value of every sequence"));
  table.rows.push_back(
      metric_row("Diversity", diversity,
                 "mean over sequences of unseen subjects of the mean distance between their predictions in "
                 "different styles, over unordered pairs, frames and vertices (FaceDiffuser's program)"));
}

Result<double> diversity_of(const PairedSequences& paired, ConsoleProgress& progress) {
  double sum = 0;
  std::int64_t count = 0;
  for (const auto& [sequence, paths] : paired.takes) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    std::vector<Motion> takes;
    for (const auto& path : paths) {
      MIEN_TRY(takes.emplace_back(), read_vertices(path, 1));
      if (takes.back().topology.num_vertices != takes.front().topology.num_vertices)
        return Error{Errc::incompatible, "'" + path.string() + "'",
                     "has another number of vertices than the other takes", ""};
    }
    sum += take_diversity(takes), ++count;
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(count);
}

Status evaluate_vertices(const SequenceArguments& a, ConsoleProgress& progress) {
  const bool facediffuser = a.system != "facexhubert", facexhubert = a.system != "facediffuser";
  if (facexhubert && a.mesh.empty())
    return Error{Errc::usage, "--system " + a.system, "needs the triangles of the surface",
                 "Pass --mesh template.obj"};
  MIEN_TRY(const PairedSequences paired, pair_sequences(a.predicted, a.truth, PairRule::vertices));
  tell_unpaired(paired, progress);
  Templates templates;
  if (!a.templates.empty()) {
    MIEN_TRY(templates, load_templates(a.templates));
  }
  Mesh mesh;
  if (!a.mesh.empty()) {
    MIEN_TRY(mesh, load_mesh(a.mesh));
  }
  std::optional<VertexErrors> errors;
  double distance_sum = 0;
  MetricTable table{"", {"value"}, {}, {}};
  progress.stage("sequences", static_cast<std::int64_t>(paired.pairs.size()));
  std::int64_t num_without_template = 0, done = 0;
  for (const auto& pair : paired.pairs) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    MIEN_TRY(const Motion truth, read_vertices(pair.truth, a.truth_every));
    MIEN_TRY(const Motion predicted, read_vertices(pair.predicted, 1));
    if (!errors) {
      MIEN_TRY(VertexRegions regions, read_regions(a.regions, truth.topology.num_vertices));
      errors.emplace(std::move(regions));
    }
    const auto neutral = templates.find(pair.subject);
    if (neutral == templates.end()) ++num_without_template;
    MIEN_TRY([[maybe_unused]] const auto added,
             errors->add(pair.predicted.stem().string(), truth, predicted,
                         neutral == templates.end() ? std::span<const float>()
                                                    : std::span<const float>(neutral->second)));
    if (facexhubert) {
      MIEN_TRY(const double distance, surface_distance(truth, predicted, mesh.triangles, a.threads));
      distance_sum += distance;
    }
    progress.update(++done);
  }
  const VertexErrors none{VertexRegions{}};
  const VertexErrors& all = errors ? *errors : none;
  if (facediffuser) {
    MIEN_TRY(const double diversity, diversity_of(paired, progress));
    add_facediffuser_rows(all, diversity, table);
    if (a.regions.empty())
      table.notes.emplace_back("LVE and FDD need --regions lve.txt fdd.txt of the data set");
    if (num_without_template > 0)
      table.notes.push_back(std::to_string(num_without_template) +
                            " sequences have no template of their subject (--templates) and no FDD");
  }
  if (facexhubert)
    table.rows.push_back(
        metric_row("surface distance",
                   paired.pairs.empty() ? std::numeric_limits<double>::quiet_NaN()
                                        : distance_sum / static_cast<double>(paired.pairs.size()),
                   "mean over vertices, frames and sequences, in this order, of the distance from "
                   "the predicted vertex to the true surface (FaceXHuBERT's mean face vertex "
                   "error; divided by the sequences, not by the files of the folder)"));
  if (a.per_sequence)
    for (const auto& e : all.sequences()) {
      table.rows.push_back(metric_row("MVE " + e.name, e.mve, "of this sequence"));
      table.rows.push_back(metric_row("LVE " + e.name, e.lve, "of this sequence"));
      table.rows.push_back(metric_row("FDD " + e.name, e.fdd, "of this sequence"));
    }
  table.title = "Vertices: " + std::to_string(paired.pairs.size()) + " sequences, " +
                std::to_string(all.num_frames()) + " frames; units of the data";
  return print(table, a.form, true);
}

// A sequence of BEAT's coefficients or UUDaMM's controls. Where the file names ARKit's coefficients, BEAT's
// 51 are gathered by name.
Result<Motion> read_controls(const fs::path& path, const std::string& system, std::int64_t width) {
  MIEN_TRY(Motion motion, read_motion(path, {.fps = 30}));
  if (motion.num_channels() == width) return motion;
  Motion gathered{MotionSpace::arkit, arkit_order(ArkitOrder::beat), motion.fps, {}};
  std::vector<std::size_t> from;
  for (const auto& name : gathered.channels)
    if (const auto found = motion.find(name)) from.push_back(static_cast<std::size_t>(*found));
  if (system != "beat" || from.size() != gathered.channels.size())
    return Error{Errc::incompatible, "'" + path.string() + "'",
                 "has " + std::to_string(motion.num_channels()) + " channels, " + system + " has " +
                     std::to_string(width),
                 ""};
  for (std::int64_t n = 0; n < motion.num_frames(); ++n)
    for (const std::size_t c : from) gathered.values.push_back(motion.frame(n)[c]);
  return gathered;
}

Status evaluate_controls(const SequenceArguments& a, ConsoleProgress& progress) {
  MIEN_TRY(const PairedSequences paired,
           pair_sequences(a.predicted, a.truth, a.system == "uudamm" ? PairRule::uudamm : PairRule::beat));
  tell_unpaired(paired, progress);
  const std::int64_t width =
      dataset_layout(a.system == "uudamm" ? DatasetKind::uudamm : DatasetKind::beat).width;
  ControlErrors errors(*control_regions(width));
  progress.stage("sequences", static_cast<std::int64_t>(paired.pairs.size()));
  for (const auto& pair : paired.pairs) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    MIEN_TRY(const Motion truth, read_controls(pair.truth, a.system, width));
    MIEN_TRY(const Motion predicted, read_controls(pair.predicted, a.system, width));
    MIEN_TRY([[maybe_unused]] const auto added, errors.add(pair.predicted.stem().string(), truth, predicted));
    progress.update(static_cast<std::int64_t>(errors.sequences().size()));
  }
  MetricTable table{"Controls of " + a.system + ": " + std::to_string(errors.sequences().size()) +
                        " sequences, " + std::to_string(errors.num_frames()) + " frames",
                    {"value"},
                    {},
                    {}};
  table.rows.push_back(
      metric_row("MCE", errors.mce(),
                 "mean over sequences of the mean over frames of |p - g|, the length over all "
                 "channels (FaceDiffuser's program)"));
  table.rows.push_back(metric_row(
      "LCE", errors.lce(), "the same over the mouth's channels alone, no maximum (FaceDiffuser's program)"));
  table.rows.push_back(metric_row(
      "C-FDD", errors.fdd(),
      "mean over sequences of: std over frames of the sum of squares of the upper face's channels, truth "
      "less prediction, population std, signed, no template (FaceDiffuser's program)"));
  table.rows.push_back(
      metric_row("ABS C-FDD", errors.absolute_fdd(), "the same with the absolute value of every sequence"));
  if (a.per_sequence)
    for (const auto& e : errors.sequences()) {
      table.rows.push_back(metric_row("MCE " + e.name, e.mce, "of this sequence"));
      table.rows.push_back(metric_row("LCE " + e.name, e.lce, "of this sequence"));
      table.rows.push_back(metric_row("C-FDD " + e.name, e.fdd, "of this sequence"));
    }
  return print(table, a.form, true);
}

std::shared_ptr<SequenceArguments> add_sequence_options(CLI::App& command, Chosen& chosen) {
  auto a = std::make_shared<SequenceArguments>();
  command.add_option("PREDICTED", a->predicted, "Predicted sequence, or a folder of them")->required();
  command.add_option("TRUTH", a->truth, "True sequence, or a folder of them")->required();
  command.add_flag("--per-sequence", a->per_sequence, "Also print every sequence");
  add_table_options(command, a->form, chosen);
  return a;
}

}  // namespace

void add_sequence_evaluations(CLI::App& evaluate, Chosen& chosen) {
  auto* vertices =
      evaluate.add_subcommand("vertices", "MVE, LVE, FDD, diversity and surface distance of meshes");
  const auto v = add_sequence_options(*vertices, chosen);
  v->system = "facediffuser";
  vertices->add_option("--system", v->system, "Whose measures: facediffuser, facexhubert or both")
      ->check(CLI::IsMember({"facediffuser", "facexhubert", "both"}))
      ->capture_default_str();
  vertices->add_option(
      "--regions", v->regions,
      "Region files of the data set: lve.txt and fdd.txt, or mouth=FILE and upper=FILE (indices or weights)");
  vertices->add_option("--templates", v->templates,
                       "Templates by subject: .pkl, .safetensors, .obj or a folder of .obj");
  vertices->add_option("--mesh", v->mesh, "Triangles for the surface distance (.obj .ply)");
  vertices->add_option("--truth-every", v->truth_every, "Keep every n-th frame of the truth (VOCASET: 2)")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  add_threads_option(*vertices, v->threads);
  add_footer(*vertices,
             "  mien evaluate vertices result data/BIWI/vertices_npy --regions lve.txt fdd.txt --templates "
             "templates.pkl\n");
  auto* controls = evaluate.add_subcommand("controls", "MCE, LCE and C-FDD of coefficients and rig controls");
  const auto c = add_sequence_options(*controls, chosen);
  c->system = "beat";
  controls->add_option("--system", c->system, "Whose channels and regions: beat or uudamm")
      ->check(CLI::IsMember({"beat", "uudamm"}))
      ->capture_default_str();
  add_footer(*controls,
             "  mien evaluate controls result data/BEAT/vertices_npy --system beat\n"
             "  mien evaluate controls kept/takes kept/truth\n");
  const auto choose = [&chosen](CLI::App* app, std::shared_ptr<SequenceArguments> a, auto work) {
    app->callback([&chosen, a, work] {
      a->form.json = chosen.json;
      chosen.work = [a, work](ConsoleProgress& progress) { return work(*a, progress); };
    });
  };
  choose(vertices, v, &evaluate_vertices);
  choose(controls, c, &evaluate_controls);
}

}  // namespace mien
