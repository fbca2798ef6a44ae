#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "mien/base/result.h"
#include "outputs.h"

namespace mien {

/// FLAME's unit is the metre.
inline constexpr double kFlameMmPerUnit = 1000;

/// Outputs of a model that gives FLAME parameters. With a FLAME model, all but .csv and .json show its
/// vertices, which is noted in them; without, an output that shows a face is an error (Errc::usage).
Status plan_flame_outputs(std::span<Output> outputs, bool has_flame);

/// What to say of files that hold parameters and no face.
std::string flame_parameters_notice(std::int64_t num_parameters);

}  // namespace mien
