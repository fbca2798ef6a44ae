// mien transfer: blendshapes for a new face, made from those of another.
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "character_source.h"
#include "facts.h"
#include "mien/base/file.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "mien/console/console_exit.h"
#include "mien/face/pose.h"
#include "mien/io/character_file.h"
#include "mien/io/gltf_writer.h"
#include "mien/io/mesh_file.h"
#include "mien/transfer/shape_comparison.h"
#include "mien/transfer/shape_transfer.h"
#include "options.h"
#include "outputs.h"
#include "printing.h"
#include "transfer_input.h"

namespace mien {
namespace {

struct TransferArguments {
  std::string target, from, output, unit = "m";
  MarkerFiles markers;
  std::vector<std::string> exclude, exclude_source;
  double reach_mm = 0;
  int threads = hardware_threads();
  bool json = false;
};

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

Facts facts_of(const TransferArguments& a, const ShapeTransferReport& report, std::size_t num_markers) {
  Facts facts;
  facts.add("kind", "transfer");
  facts.add("output", a.output);
  facts.add("markers", static_cast<std::int64_t>(num_markers));
  facts.add("scale_of_the_source", report.similarity.scale, 4);
  facts.add("registration_median", percentile(report.distance_mm, 0.5), 2, "mm");
  facts.add("registration_95_percent", percentile(report.distance_mm, 0.95), 2, "mm");
  facts.add("triangles", static_cast<std::int64_t>(report.num_triangles));
  facts.add("triangles_with_partner", static_cast<std::int64_t>(report.num_paired));
  facts.add("vertices_held", static_cast<std::int64_t>(report.num_held));
  facts.add("vertices_tied", static_cast<std::int64_t>(report.num_ties));
  facts.add("registration_seconds", report.registration_seconds, 3, "s");
  facts.add("factor_seconds", report.factor_seconds, 3, "s");
  facts.add("shapes_seconds", report.solve_seconds, 3, "s");
  std::string json;
  char line[160];
  std::snprintf(line, sizeof(line), "  %-22s %12s %12s %10s\n", "shape", "source mm", "target mm", "misfit");
  std::string text = line;
  for (const TransferredShape& s : report.shapes) {
    std::snprintf(line, sizeof(line), "  %-22s %12s %12s %10s\n", s.name.c_str(),
                  fixed(s.source_mm, 2).c_str(), fixed(s.target_mm, 2).c_str(), fixed(s.misfit, 4).c_str());
    text += line;
    json += (json.empty() ? "{\"name\":" : ",{\"name\":") + json_string(s.name) +
            ",\"source_mm\":" + fixed(s.source_mm, 4) + ",\"target_mm\":" + fixed(s.target_mm, 4) +
            ",\"misfit\":" + fixed(s.misfit, 6) + "}";
  }
  facts.add_table("shapes", std::move(text), "[" + json + "]");
  return facts;
}

// Where the target had shapes of these names, made by someone else: how far the new ones are from them.
void add_comparison(const std::vector<ShapeComparison>& comparisons, Facts& facts) {
  if (comparisons.empty()) return;
  char line[200];
  const auto row = [&](const std::string& name, double mean, double most, double mean_percent,
                       double max_percent, double cosine) {
    std::snprintf(line, sizeof(line), "  %-22s %9s %9s %8s %8s %8s\n", name.c_str(), fixed(mean, 3).c_str(),
                  fixed(most, 2).c_str(), fixed(mean_percent, 1).c_str(), fixed(max_percent, 1).c_str(),
                  fixed(cosine, 3).c_str());
    return std::string(line);
  };
  std::snprintf(line, sizeof(line), "  %-22s %9s %9s %8s %8s %8s\n", "shape", "mean mm", "max mm", "mean %",
                "max %", "cosine");
  std::string text = line, json;
  std::vector<double> mean, most, mean_percent, max_percent, cosine;
  for (const ShapeComparison& c : comparisons) {
    text += row(c.name, c.mean_mm, c.max_mm, c.mean_percent(), c.max_percent(), c.cosine);
    json += (json.empty() ? "{\"name\":" : ",{\"name\":") + json_string(c.name) +
            ",\"mean_mm\":" + fixed(c.mean_mm, 6) + ",\"max_mm\":" + fixed(c.max_mm, 6) +
            ",\"largest_mm\":" + fixed(c.largest_mm, 6) + ",\"cosine\":" + fixed(c.cosine, 6) + "}";
    mean.push_back(c.mean_mm), most.push_back(c.max_mm), cosine.push_back(c.cosine);
    mean_percent.push_back(c.mean_percent()), max_percent.push_back(c.max_percent());
  }
  text += row("median", percentile(mean, 0.5), percentile(most, 0.5), percentile(mean_percent, 0.5),
              percentile(max_percent, 0.5), percentile(cosine, 0.5));
  facts.add_table("against_the_targets_own", std::move(text), "[" + json + "]");
}

// The shapes of the merged mesh, back in the parts.
void give_shapes(Character& character, const std::vector<Blendshape>& shapes) {
  std::uint32_t first = 0;
  for (auto& part : character.parts) {
    const auto end = first + static_cast<std::uint32_t>(part.mesh.positions.size());
    part.shapes.clear();
    for (const auto& shape : shapes) {
      Blendshape own{shape.name, {}, {}, {}};
      for (std::size_t m = 0; m < shape.vertices.size(); ++m)
        if (shape.vertices[m] >= first && shape.vertices[m] < end) {
          own.vertices.push_back(shape.vertices[m] - first);
          own.offsets.push_back(shape.offsets[m]);
        }
      if (!own.vertices.empty()) part.shapes.push_back(std::move(own));
    }
    first = end;
  }
}

// Landmarks of the source become the target's where every one has its marker.
void give_landmarks(Character& target, const Character& source, const std::vector<Marker>& markers) {
  const auto theirs = source.regions.find("landmarks68");
  if (target.regions.contains("landmarks68") || theirs == source.regions.end()) return;
  std::vector<std::uint32_t> ours;
  for (const auto v : theirs->second) {
    const auto marker =
        std::find_if(markers.begin(), markers.end(), [&](const auto& m) { return m.source == v; });
    if (marker == markers.end() || marker->target >= target.parts.front().mesh.positions.size()) return;
    ours.push_back(marker->target);
  }
  target.regions["landmarks68"] = std::move(ours);
}

Status run_transfer(const TransferArguments& a, ConsoleProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  MIEN_TRY(const auto from, character_path(a.from));
  const std::array<std::filesystem::path, 5> inputs = {
      a.target, from, a.markers.pairs, a.markers.source_landmarks, a.markers.target_landmarks};
  constexpr OutputKind kKinds[] = {OutputKind::motion};
  MIEN_TRY(const auto outputs, plan_outputs({&a.output, 1}, inputs, kKinds));
  if (!outputs.front().is_glb())
    return Error{Errc::usage, "output '" + a.output + "'", "a character is written as .glb",
                 "Name it FACE.glb"};
  progress.event("start", "\"command\":\"transfer\",\"input\":" + json_string(a.target) + ",\"outputs\":[" +
                              json_string(a.output) + "]");
  MIEN_TRY([[maybe_unused]] const auto writable, check_writable(outputs));

  const auto source = load_character(from);
  if (!source) return source.error();
  auto target = load_target(a.target, a.unit);
  if (!target) return target.error();
  for (const auto& warning : target.warnings)
    if (!warning.starts_with("no shape")) progress.warn(warning);
  const CharacterPart& skin = source->parts.front();
  if (skin.shapes.empty())
    return Error{Errc::incompatible, "--from '" + from.string() + "'", "has no shapes to transfer",
                 "Use a face with ARKit shapes; without --from Mien's own head is the source"};
  Character only_skin{source->name, {skin}, source->regions};
  MIEN_TRY(const auto markers, read_markers(a.markers, only_skin, *target));
  MIEN_TRY(auto out_of_source, read_exclusions(a.exclude_source, only_skin));
  MIEN_TRY(auto out_of_target, read_exclusions(a.exclude, *target));

  const Mesh merged = merged_mesh(*target);
  const auto own_shapes = merged_shapes(*target);
  const auto not_compared = out_of_target;
  ShapeTransferOptions options;
  options.registration.reach = a.reach_mm / 1000;
  options.num_threads = a.threads;
  const auto made = transfer_shapes({&skin.mesh, std::move(out_of_source)}, skin.shapes,
                                    {&merged, std::move(out_of_target)}, markers, options, progress);
  if (!made) return made.error();
  for (const auto& warning : made.warnings) progress.warn(warning);
  give_shapes(*target, made->shapes);
  give_landmarks(*target, *source, markers);
  MIEN_TRY(const Bytes glb,
           write_glb(*target, {.normals = true, .pivot = neck_pivot(*target), .extras = {}}));
  MIEN_TRY([[maybe_unused]] const auto written,
           write_file(outputs.front().path, std::span<const std::byte>(glb)));

  progress.finish_line();
  Facts facts = facts_of(a, made->report, markers.size());
  add_comparison(compare_shapes(made->shapes, own_shapes, not_compared), facts);
  MIEN_TRY([[maybe_unused]] const auto printed, print(a.json ? facts.to_json() : facts.to_text()));
  const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  progress.event("success", "\"outputs\":[" + json_string(a.output) + "],\"shapes\":" +
                                std::to_string(made->shapes.size()) + ",\"seconds\":" + fixed(taken, 3));
  progress.say("wrote " + a.output + ": " + std::to_string(made->shapes.size()) + " shapes for " +
               std::to_string(merged.positions.size()) + " vertices in " + fixed(taken, 2) + " s");
  return Done{};
}

}  // namespace

void add_transfer_command(CLI::App& program, Chosen& chosen) {
  auto* command = program.add_subcommand("transfer", "Make the shapes of one face for another mesh");
  auto a = std::make_shared<TransferArguments>();
  command
      ->add_option("TARGET", a->target,
                   "The face at rest: .obj .ply, a FLAME model (.pkl .npz), or a character (.glb .gltf .vrm "
                   ".safetensors), of any topology")
      ->required();
  command->add_option("-o,--output", a->output, "Character to write (.glb), for animate --character")
      ->required();
  command->add_option(
      "--from", a->from,
      "Character with the shapes, or a folder of neutral.obj and a mesh per shape. Its first part "
      "counts. Default: Mien's head");
  command->add_option("--markers", a->markers.pairs,
                      "Pairs of vertices at the same place of both faces, one a line: source,target");
  command->add_option("--source-landmarks", a->markers.source_landmarks,
                      "Landmarks of the source, a vertex a line. Default: its own landmarks68");
  command->add_option("--target-landmarks", a->markers.target_landmarks,
                      "The same places of the target, in the same order. Default: its own landmarks68");
  command->add_option("--exclude", a->exclude,
                      "What of the target takes no part and stays still: a file of vertices, 9409-24590, the "
                      "name of a part, or islands (all but the largest connected piece)");
  command->add_option("--exclude-source", a->exclude_source, "The same for the source");
  command->add_option("--unit", a->unit, "Unit of a .obj or .ply: m, cm or mm")
      ->check(CLI::IsMember({"m", "cm", "mm"}))
      ->capture_default_str();
  command
      ->add_option(
          "--reach", a->reach_mm,
          "How far apart the two faces may lie, in mm. Default: 14 % of the markers' spread, about 8 mm")
      ->check(CLI::Range(0.1, 1000.0));
  add_threads_option(*command, a->threads);
  command->add_flag("--quiet", chosen.quiet, "Print no progress");
  command->add_flag("--json", chosen.json, "Print the report as JSON, progress as JSON lines on stderr");
  add_footer(
      *command,
      "  mien transfer face.obj --target-landmarks face68.txt -o face.glb\n"
      "  mien transfer head.ply --unit cm --from rig.glb --markers pairs.csv --exclude islands -o head.glb\n"
      "  mien animate hello.wav --character face.glb -o hello.glb\n");
  command->callback([a, &chosen] {
    a->json = chosen.json;
    chosen.work = [a](ConsoleProgress& progress) { return run_transfer(*a, progress); };
  });
}

}  // namespace mien
