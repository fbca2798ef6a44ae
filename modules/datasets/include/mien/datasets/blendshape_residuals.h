#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mien/base/result.h"

namespace mien {

/// What each blendshape adds to a person's neutral face: x, y, z of vertex 0, then of vertex 1 ...; [3 V] in
/// the units of the data set, by shape.
using ShapeResiduals = std::map<std::string, std::vector<float>>;

/// The blendshapes of persons as BlendVOCA has them (specification of SAiD, sections 10.1 and 10.2): a Python
/// dictionary person -> shape -> array [V, 3], of the vertices that FLAME_head_idx.txt lists. By person.
/// Errors: Errc::input for damaged files; Errc::incompatible for other dictionaries, arrays of differing
/// sizes and numbers that are not finite, each by person and shape.
Result<std::map<std::string, ShapeResiduals>> load_blendshape_residuals(const std::filesystem::path& path);

}  // namespace mien
