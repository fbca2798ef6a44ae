#include "flame_outputs.h"

#include <algorithm>

#include "mien/face/flame.h"
#include "mien/io/motion_file.h"

namespace mien {
namespace {

constexpr double kMmPerMetre = 1000;

bool holds_parameters(const Output& output) {
  const auto extension = output.path.extension();
  return output.kind == OutputKind::motion && (extension == ".csv" || extension == ".json");
}

}  // namespace

Status check_flame_outputs(std::span<const Output> outputs) {
  for (const auto& output : outputs)
    if (output.kind != OutputKind::motion || output.is_glb())
      return Error{Errc::usage, "output '" + output.path.string() + "'",
                   "shows a face, and this model gives FLAME parameters",
                   "Pass --flame generic_model.pkl to have a face, or write .npy, .csv or .json"};
  return Done{};
}

Status write_flame_outputs(std::span<const Output> outputs, const Motion& parameters, const FlameModel& flame,
                           const VertexOptions& options, const VertexShow& show, ConsoleProgress& progress) {
  VertexOptions metric = options;
  if (metric.mm_per_unit == 0) metric.mm_per_unit = kMmPerMetre;
  Motion vertices;
  if (!std::ranges::all_of(outputs, holds_parameters)) {
    MIEN_TRY(vertices, flame_vertices(FlamePoser(flame), parameters, show.pictures.threads));
  }
  const Mesh mesh = flame_mesh(flame);
  for (const auto& output : outputs) {
    const Status written = holds_parameters(output)
                               ? write_motion(output.path, parameters,
                                              {.character_glb = {}, .audio_name = show.audio_name, .glb = {}})
                               : write_vertex_output(output, vertices, mesh, metric, show, progress);
    if (!written) return written.error();
    for (const auto& warning : written.warnings) progress.warn(warning);
  }
  return Done{};
}

std::string flame_parameters_notice(const Motion& parameters) {
  return "the files hold " + std::to_string(parameters.num_channels()) +
         " FLAME parameters a frame and no vertices: those need a FLAME model (--flame generic_model.pkl), "
         "which has a licence of its own";
}

}  // namespace mien
