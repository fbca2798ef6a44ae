#include "even_motion.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"

namespace mien::io {
namespace {

constexpr std::int64_t kFramesPerHour = 60 * 3600;

// In double, since the difference of two large floats may not be one.
float between(float a, float b, double weight) {
  return static_cast<float>(a + weight * (static_cast<double>(b) - a));
}

}  // namespace

Status check_frames(const Motion& format, std::int64_t first, std::span<const float> values,
                    std::string_view writer) {
  const auto width = static_cast<std::size_t>(format.num_channels());
  contract(width == 0 ? values.empty() : values.size() % width == 0,
           "check_frames: the values are not whole frames");
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    return Error{Errc::failed, std::string(writer),
                 "channel '" + format.channel_name(static_cast<std::int64_t>(i % width)) +
                     "' is not finite at frame " +
                     std::to_string(first + static_cast<std::int64_t>(i / width)),
                 ""};
  }
  return Done{};
}

Status check_motion(const Motion& motion, std::string_view writer) {
  if (!(motion.fps > 0) || !std::isfinite(motion.fps))
    return Error{Errc::failed, std::string(writer), "the frame rate of the motion is not a positive number",
                 ""};
  return check_frames(motion, 0, motion.values, writer);
}

KeyPosition find_key(const std::vector<double>& times, double time, double snap) {
  const auto above = std::upper_bound(times.begin(), times.end(), time);
  if (above == times.begin()) return {0, 0};
  const auto key = static_cast<std::size_t>(above - times.begin()) - 1;
  if (above == times.end() || time - times[key] <= snap) return {key, 0};
  if (*above - time <= snap) return {key + 1, 0};
  return {key, (time - times[key]) / (*above - times[key])};
}

Result<std::int64_t> num_even_frames(double last_time, double fps, std::size_t num_keys) {
  const double frames = std::floor(last_time * fps + 0.5) + 1;
  const double limit = static_cast<double>(kFramesPerHour) + 8.0 * static_cast<double>(num_keys);
  if (!(frames <= limit))
    return Error{Errc::input, "motion",
                 "it lasts " + std::to_string(static_cast<long long>(std::min(last_time, 1e15))) +
                     " s, too long for its " + std::to_string(num_keys) + " rows",
                 ""};
  return static_cast<std::int64_t>(frames);
}

Result<Motion> even_motion(const std::vector<double>& times, const std::vector<float>& rows,
                           std::vector<std::string> channels, double fps) {
  Motion motion{MotionSpace::arkit, std::move(channels), fps, {}};
  if (times.empty()) return motion;
  MIEN_TRY(const std::int64_t num_frames, num_even_frames(times.back(), fps, times.size()));
  const std::size_t width = motion.channels.size();
  motion.values.resize(static_cast<std::size_t>(num_frames) * width);
  for (std::int64_t n = 0; n < num_frames; ++n) {
    const KeyPosition at = find_key(times, static_cast<double>(n) / fps, kSnapFrames / fps);
    const float* a = &rows[at.key * width];
    const float* b = at.weight > 0 ? a + width : a;
    const auto out = motion.frame(n);
    for (std::size_t c = 0; c < width; ++c) out[c] = between(a[c], b[c], at.weight);
  }
  return motion;
}

}  // namespace mien::io
