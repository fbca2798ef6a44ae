#include "mien/models/said/alignment.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"

namespace mien::said {
namespace {

// To nearest, ties to even, whatever the rounding mode of the process.
double round_half_even(double value) {
  const double below = std::floor(value), part = value - below;
  if (part != 0.5) return part < 0.5 ? below : below + 1;
  return std::fmod(below, 2.0) == 0 ? below : below + 1;
}

}  // namespace

std::vector<KeyRange> aligned_keys(std::int64_t num_frames, std::int64_t num_context_frames) {
  contract(num_frames == 0 || (num_frames > 0 && num_context_frames > 0),
           "aligned_keys: frames of context are needed");
  constexpr double kReach = 1;  // frames to either side
  const double ratio = static_cast<double>(num_context_frames) / static_cast<double>(num_frames);
  const double half_width = ratio / 2 + kReach;
  std::vector<KeyRange> ranges;
  for (std::int64_t i = 0; i < num_frames; ++i) {
    const double center = (static_cast<double>(i) + 0.5) * ratio;
    const auto first = static_cast<std::int64_t>(round_half_even(center - half_width));
    const auto end = static_cast<std::int64_t>(round_half_even(center + half_width));
    ranges.push_back({std::max<std::int64_t>(first, 0), std::min(end, num_context_frames)});
  }
  return ranges;
}

std::vector<float> step_sinusoids(std::span<const std::int64_t> steps, std::int64_t width) {
  contract(width > 0 && width % 2 == 0, "step_sinusoids: the width must be even");
  const std::int64_t half = width / 2;
  const auto log_period = static_cast<float>(-std::log(10000.0));
  std::vector<float> values;
  for (const std::int64_t step : steps)
    for (const bool is_sine : {false, true})
      for (std::int64_t i = 0; i < half; ++i) {
        const float exponent = log_period * static_cast<float>(i) / static_cast<float>(half);
        const float angle = static_cast<float>(step) * std::exp(exponent);
        values.push_back(is_sine ? std::sin(angle) : std::cos(angle));
      }
  return values;
}

}  // namespace mien::said
