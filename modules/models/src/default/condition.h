#pragma once
#include "mien/models/default/default_model.h"
#include "mien/models/direction.h"

namespace mien::default_model {

/// The network's view of a direction at the given instants: [n, ..] each; one row when the direction is
/// constant.
ConditionInput<Tensor> condition_input(const Direction& direction, std::span<const double> seconds,
                                       std::span<const float, kNumLatents> latents);

}  // namespace mien::default_model
