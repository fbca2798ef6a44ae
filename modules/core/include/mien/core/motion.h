#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mien {

/// What the channels of a Motion are.
enum class MotionSpace {
  arkit,     ///< ARKit coefficients (0 ... 1) by name, optionally headYaw, headPitch, headRoll in degrees
  flame,     ///< FLAME expression and jaw parameters
  vertices,  ///< x, y, z of every vertex of a named topology, metres
  rig,       ///< other named controls
};

/// Facial motion: N frames of C channels, row-major. Frame n is the instant n / fps; time zero is the first audio
/// sample.
struct Motion {
  MotionSpace space = MotionSpace::arkit;
  std::vector<std::string> channels;  // [C]
  double fps = 60;
  std::vector<float> values;  // [N, C]

  [[nodiscard]] std::int64_t num_channels() const { return static_cast<std::int64_t>(channels.size()); }
  [[nodiscard]] std::int64_t num_frames() const {
    return channels.empty() ? 0 : static_cast<std::int64_t>(values.size() / channels.size());
  }
  [[nodiscard]] double seconds() const { return static_cast<double>(num_frames()) / fps; }
  [[nodiscard]] std::span<float> frame(std::int64_t n) {
    return std::span(values).subspan(static_cast<std::size_t>(n) * channels.size(), channels.size());
  }
  [[nodiscard]] std::span<const float> frame(std::int64_t n) const {
    return std::span(values).subspan(static_cast<std::size_t>(n) * channels.size(), channels.size());
  }
  /// Index of a channel by its exact name.
  [[nodiscard]] std::optional<std::int64_t> find(std::string_view channel) const;
};

/// Frames that cover `seconds` of sound: round(seconds * fps), half away from zero. The one rounding rule.
[[nodiscard]] std::int64_t num_motion_frames(double seconds, double fps);

/// Linear interpolation in time to another rate; the end values hold. Keeps bounds, zeros and time zero.
/// @pre fps > 0
[[nodiscard]] Motion resample(const Motion& motion, double fps);

}  // namespace mien
