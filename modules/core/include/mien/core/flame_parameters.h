#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mien/core/motion.h"

namespace mien {

// FLAME's parameters as channels of a Motion (space `flame`): shape_0 ..., expression_0 ..., without unit,
// and jaw_x, jaw_y, jaw_z, the jaw's rotation as an axis times an angle in radians. A motion may have any of
// them; those it lacks are 0. ProbTalk3D's files hold all 403 in this order.
inline constexpr std::size_t kNumFlameShape = 300, kNumFlameExpression = 100, kNumFlameJaw = 3;
inline constexpr std::size_t kNumFlame = kNumFlameShape + kNumFlameExpression + kNumFlameJaw;

/// Names of the first parameters of both kinds, and of the jaw. @pre at most as many as there are
std::vector<std::string> flame_channels(std::size_t num_shape, std::size_t num_expression);
/// Place of a parameter among the 403; nothing for another name.
std::optional<std::size_t> flame_column(std::string_view channel);
/// For each channel of a motion its place. @pre the space is `flame`; channels of other names have no place
std::vector<std::optional<std::size_t>> flame_columns(const Motion& motion);

}  // namespace mien
