#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/core/topology.h"
#include "mien/core/vector.h"

namespace mien {

/// What the channels of a Motion are.
enum class MotionSpace {
  arkit,     ///< ARKit coefficients (0 ... 1) by name, optionally headYaw, headPitch, headRoll in degrees
  flame,     ///< FLAME parameters by name (flame_parameters.h)
  vertices,  ///< x, y, z of every vertex of a topology, in the units of its data set
  rig,       ///< other named controls
};

/// Facial motion: N frames of C channels, row-major. Frame n is the instant n / fps; time zero is the first
/// audio sample.
struct Motion {
  MotionSpace space = MotionSpace::arkit;
  std::vector<std::string> channels;  // [C]; empty in the space `vertices`, whose C follows from the topology
  double fps = 60;
  std::vector<float> values;  // [N, C]
  Topology topology =
      {};  ///< of the space `vertices`, where C = 3 V: x, y, z of vertex 0, then of vertex 1 ...

  /// C. A mesh has tens of thousands of channels, so they are counted and not named.
  [[nodiscard]] std::int64_t num_channels() const {
    return space == MotionSpace::vertices ? 3 * topology.num_vertices
                                          : static_cast<std::int64_t>(channels.size());
  }
  [[nodiscard]] std::int64_t num_frames() const {
    const std::int64_t width = num_channels();
    return width == 0 ? 0 : static_cast<std::int64_t>(values.size()) / width;
  }
  [[nodiscard]] double seconds() const { return static_cast<double>(num_frames()) / fps; }
  [[nodiscard]] std::span<float> frame(std::int64_t n) {
    const auto width = static_cast<std::size_t>(num_channels());
    return std::span(values).subspan(static_cast<std::size_t>(n) * width, width);
  }
  [[nodiscard]] std::span<const float> frame(std::int64_t n) const {
    const auto width = static_cast<std::size_t>(num_channels());
    return std::span(values).subspan(static_cast<std::size_t>(n) * width, width);
  }
  /// Index of a named channel by its exact name; nothing in the space `vertices`.
  [[nodiscard]] std::optional<std::int64_t> find(std::string_view channel) const;
  /// What to call a channel in a message: its name, or "vertex 12 y". @pre 0 <= c < num_channels()
  [[nodiscard]] std::string channel_name(std::int64_t c) const;
};

/// Motion of vertices. @param values  [N, 3 V] @pre fps > 0, at least one vertex, whole frames
[[nodiscard]] Motion vertex_motion(Topology topology, double fps, std::vector<float> values = {});

/// Positions of frame n as points. @param out  [V] @pre space `vertices`, sizes agree
void copy_positions(const Motion& motion, std::int64_t n, std::span<Vec3> out);

/// Frames that cover `seconds` of sound: round(seconds * fps), half away from zero. The one rounding rule.
[[nodiscard]] std::int64_t num_motion_frames(double seconds, double fps);

/// Linear interpolation in time to another rate; the end values hold. Keeps bounds, zeros and time zero.
/// @pre fps > 0
[[nodiscard]] Motion resample(const Motion& motion, double fps);

}  // namespace mien
