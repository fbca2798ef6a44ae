#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mien/base/result.h"

namespace mien {

/// Neutral meshes by subject: x, y, z of vertex 0, then of vertex 1 ...; [3 V] in the units of the data set.
using Templates = std::map<std::string, std::vector<float>>;

/// Templates from
/// - .pkl: a Python dictionary subject -> array [V, 3] (templates.pkl, templates_scaled.pkl,
/// templates_orig.pkl);
/// - .safetensors: tensors `template.<subject>`, as in a model file;
/// - .obj or .ply: one mesh, for the subject that the file is named after;
/// - a folder of .obj and .ply files.
/// Errors: Errc::input for damaged files and numbers that are not finite, Errc::incompatible for files of
/// another kind or templates of differing size.
Result<Templates> load_templates(const std::filesystem::path& path);

/// As `template.<subject>` F32 [V, 3].
Status write_templates(const std::filesystem::path& path, const Templates& templates);

}  // namespace mien
