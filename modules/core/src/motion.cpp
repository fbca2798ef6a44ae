#include "mien/core/motion.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"

namespace mien {

std::optional<std::int64_t> Motion::find(std::string_view channel) const {
  const auto found = std::find(channels.begin(), channels.end(), channel);
  if (found == channels.end()) return std::nullopt;
  return found - channels.begin();
}

std::int64_t num_motion_frames(double seconds, double fps) { return std::llround(seconds * fps); }

Motion resample(const Motion& motion, double fps) {
  contract(fps > 0 && motion.fps > 0, "resample: frame rates must be positive");
  if (fps == motion.fps) return motion;
  Motion out{motion.space, motion.channels, fps, {}};
  const std::int64_t num_in = motion.num_frames();
  if (num_in == 0) return out;
  const std::int64_t num_out = std::max<std::int64_t>(1, num_motion_frames(motion.seconds(), fps));
  out.values.resize(static_cast<std::size_t>(num_out) * motion.channels.size());
  for (std::int64_t n = 0; n < num_out; ++n) {
    const double position = std::min(static_cast<double>(n) * motion.fps / fps, static_cast<double>(num_in - 1));
    const auto left = static_cast<std::int64_t>(position);
    const auto right = std::min(left + 1, num_in - 1);
    const auto w = static_cast<float>(position - static_cast<double>(left));
    const auto a = motion.frame(left), b = motion.frame(right);
    const auto y = out.frame(n);
    for (std::size_t c = 0; c < y.size(); ++c) y[c] = a[c] + w * (b[c] - a[c]);
  }
  return out;
}

}  // namespace mien
