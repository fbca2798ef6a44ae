#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "mien/base/result.h"
#include "outputs.h"

namespace mien {

/// FLAME's unit is the metre.
inline constexpr double kFlameMmPerUnit = 1000;

/// What becomes of the FLAME parameters that a model gives.
enum class FlameFace {
  none,      ///< nothing: they are what is written
  vertices,  ///< the face of a FLAME model
  rig,       ///< coefficients of a rig on FLAME's topology
};

/// Outputs of a model that gives FLAME parameters, with the note which of them are made of these: on a rig
/// all, with a FLAME model all but .csv and .json, which stay parameters; without one, an output that shows a
/// face is an error (Errc::usage).
Status plan_flame_outputs(std::span<Output> outputs, FlameFace face);

/// What to say of files that hold parameters and no face.
std::string flame_parameters_notice(std::int64_t num_parameters);

}  // namespace mien
