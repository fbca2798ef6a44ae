#include "flame_outputs.h"

namespace mien {

Status plan_flame_outputs(std::span<Output> outputs, FlameFace face) {
  for (Output& output : outputs) {
    const auto extension = output.path.extension();
    const bool is_text = output.kind == OutputKind::motion && (extension == ".csv" || extension == ".json");
    output.is_derived = face == FlameFace::rig || (face == FlameFace::vertices && !is_text);
    if (face == FlameFace::none && (output.kind != OutputKind::motion || output.is_glb()))
      return Error{Errc::usage, "output '" + output.path.string() + "'",
                   "shows a face, and this model gives FLAME parameters",
                   "Write .npy, .csv or .json; mien animate --flame generic_model.pkl makes a face"};
  }
  return Done{};
}

std::string flame_parameters_notice(std::int64_t num_parameters) {
  return "the files hold " + std::to_string(num_parameters) +
         " FLAME parameters a frame and no vertices: those need a FLAME model (--flame generic_model.pkl), "
         "which has a licence of its own";
}

}  // namespace mien
