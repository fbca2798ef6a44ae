#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace mien::train {

/// Frames first ... first + count - 1 of a sequence [N, K]; the first and the last frame go on outside it
/// (specification of SAiD, section 7.1). @pre N > 0
std::vector<float> replicated_window(std::span<const float> sequence, std::int64_t num_channels,
                                     std::int64_t first, std::int64_t count);

/// Where each coefficient of a mirrored face comes from: the one of the other side for names that end in Left
/// and Right, else itself. mirrored[k] = original[result[k]].
std::vector<std::size_t> mirror_order(std::span<const std::string_view> names);

/// In place, [N, K]. @pre K == order.size()
void mirror_coefficients(std::span<float> sequence, std::span<const std::size_t> order);

}  // namespace mien::train
