#include "mien/train/coefficient_window.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "mien/base/contract.h"

namespace mien::train {

std::int64_t draw_window_start(Rng& random, std::int64_t num_frames, std::int64_t window) {
  contract(num_frames > 0 && window > 0, "draw_window_start: no frame to draw");
  const std::int64_t half = window / 2, last = std::max<std::int64_t>(0, num_frames - half - 1);
  return static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(last + half + 1))) - half;
}

std::vector<float> replicated_window(std::span<const float> sequence, std::int64_t num_channels,
                                     std::int64_t first, std::int64_t count) {
  contract(
      num_channels > 0 && !sequence.empty() && sequence.size() % static_cast<std::size_t>(num_channels) == 0,
      "replicated_window: whole frames are needed");
  const std::int64_t num_frames = static_cast<std::int64_t>(sequence.size()) / num_channels;
  std::vector<float> window;
  window.reserve(static_cast<std::size_t>(count * num_channels));
  for (std::int64_t n = 0; n < count; ++n) {
    const std::int64_t from = std::clamp<std::int64_t>(first + n, 0, num_frames - 1) * num_channels;
    const auto frame =
        sequence.subspan(static_cast<std::size_t>(from), static_cast<std::size_t>(num_channels));
    window.insert(window.end(), frame.begin(), frame.end());
  }
  return window;
}

std::vector<std::size_t> mirror_order(std::span<const std::string> names) {
  const auto other_side = [](std::string_view name) {
    for (const auto& [side, other] : {std::pair{"Left", "Right"}, {"Right", "Left"}})
      if (name.ends_with(side))
        return std::string(name.substr(0, name.size() - std::string_view(side).size())) + other;
    return std::string(name);
  };
  std::vector<std::size_t> order(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = std::ranges::find(names, other_side(names[i]));
    order[i] = found == names.end() ? i : static_cast<std::size_t>(found - names.begin());
  }
  return order;
}

void mirror_coefficients(std::span<float> sequence, std::span<const std::size_t> order) {
  contract(!order.empty() && sequence.size() % order.size() == 0,
           "mirror_coefficients: whole frames are needed");
  std::vector<float> frame(order.size());
  for (std::size_t at = 0; at < sequence.size(); at += order.size()) {
    for (std::size_t k = 0; k < order.size(); ++k) frame[k] = sequence[at + order[k]];
    std::ranges::copy(frame, sequence.begin() + static_cast<std::ptrdiff_t>(at));
  }
}

}  // namespace mien::train
