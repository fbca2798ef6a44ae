#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mien/base/result.h"

namespace mien {

enum class OutputKind {
  motion,  ///< .glb, .csv, .json, .npy
  video,   ///< .mp4, .webm
  sheet,   ///< .png: a contact sheet
  frames,  ///< a folder of numbered pictures, written with a slash at the end
  meshes,  ///< a folder/ whose name ends in .obj or .vl, of one file per frame of vertices
};

struct Output {
  std::filesystem::path path;
  OutputKind kind = OutputKind::motion;
  /// Not what the model gives but made of all of it: vertices or coefficients of FLAME parameters, the
  /// movement of another face.
  bool is_derived = false;

  [[nodiscard]] bool is_picture() const { return kind != OutputKind::motion && kind != OutputKind::meshes; }
  [[nodiscard]] bool is_folder() const { return kind == OutputKind::frames || kind == OutputKind::meshes; }
  [[nodiscard]] bool is_glb() const;
};

/// Outputs of all takes, take by take; kinds by extension. Take k of several gets a number: "hello-1.glb" ...
/// Errors (Errc::usage): an extension that nothing writes (the message lists those that `allowed` holds), the
/// same output twice, an output that is one of the inputs.
Result<std::vector<Output>> plan_outputs(std::span<const std::string> names,
                                         std::span<const std::filesystem::path> inputs,
                                         std::span<const OutputKind> allowed, int num_takes = 1);

/// "a.glb, frames/" for people, and a JSON array of paths for programs.
std::string output_list(const std::vector<Output>& outputs);
std::string json_list(const std::vector<Output>& outputs);

/// Tries to write at every place, and leaves nothing there: long work must not end in an error that could
/// have been seen at its start. Errors (Errc::failed): a missing or read-only folder, a folder of the name.
Status check_writable(std::span<const Output> outputs);

}  // namespace mien
