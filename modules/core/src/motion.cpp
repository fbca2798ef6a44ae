#include "mien/core/motion.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/core/motion_resampler.h"

namespace mien {

std::optional<std::int64_t> Motion::find(std::string_view channel) const {
  const auto found = std::find(channels.begin(), channels.end(), channel);
  if (found == channels.end()) return std::nullopt;
  return found - channels.begin();
}

std::string Motion::channel_name(std::int64_t c) const {
  contract(c >= 0 && c < num_channels(), "Motion::channel_name: no such channel");
  if (space != MotionSpace::vertices) return channels[static_cast<std::size_t>(c)];
  return "vertex " + std::to_string(c / 3) + " " + "xyz"[c % 3];
}

Motion vertex_motion(Topology topology, double fps, std::vector<float> values) {
  contract(fps > 0 && topology.num_vertices > 0, "vertex_motion: a rate and vertices expected");
  contract(values.size() % (3 * static_cast<std::size_t>(topology.num_vertices)) == 0,
           "vertex_motion: the values are not whole frames");
  return {MotionSpace::vertices, {}, fps, std::move(values), std::move(topology)};
}

void copy_positions(const Motion& motion, std::int64_t n, std::span<Vec3> out) {
  contract(motion.space == MotionSpace::vertices && n >= 0 && n < motion.num_frames() &&
               static_cast<std::int64_t>(out.size()) == motion.topology.num_vertices,
           "copy_positions: a frame of vertices and as many points expected");
  const auto frame = motion.frame(n);
  for (std::size_t v = 0; v < out.size(); ++v) out[v] = {frame[3 * v], frame[3 * v + 1], frame[3 * v + 2]};
}

std::int64_t num_motion_frames(double seconds, double fps) { return std::llround(seconds * fps); }

Motion resample(const Motion& motion, double fps) {
  contract(fps > 0 && motion.fps > 0, "resample: frame rates must be positive");
  if (fps == motion.fps) return motion;
  Motion out{motion.space, motion.channels, fps, {}, motion.topology};
  if (motion.num_frames() == 0) return out;
  MotionResampler resampler(motion.fps, fps, motion.num_channels());
  resampler.push(motion.values, out.values);
  resampler.finish(out.values);
  return out;
}

}  // namespace mien
