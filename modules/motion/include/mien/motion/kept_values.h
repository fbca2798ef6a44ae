#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/motion/schedule.h"

namespace mien {

/// Frames first ... end - 1.
struct FrameRange {
  std::int64_t first = 0, end = 0;
  friend bool operator==(const FrameRange&, const FrameRange&) = default;
};

/// Frames of a motion whose instants lie in "1.20-2.05": seconds, both ends included. Errors (Errc::usage):
/// not of this form, the end before the start, no frame in it, a part beyond the end of the motion.
Result<FrameRange> frames_of_range(std::string_view text, const Motion& motion);

/// Channels whose names match a pattern, in their order: * stands for any letters, ? for one; a name without
/// either may be any spelling of an ARKit name (match_arkit_name()). Empty when none matches.
std::vector<std::int64_t> matching_channels(const Motion& motion, std::string_view pattern);

/// What an edit keeps of a motion of [N, C]: a weight and a value for each frame n and channel c. Weight 1 is
/// kept as it is, 0 is made anew, and what lies between is blended (SAiD, section 3.3; its masks are these
/// weights).
class KeptValues {
 public:
  /// Keeps nothing yet; the values are those of the motion.
  explicit KeptValues(const Motion& motion);
  /// @param values   [N, C]
  /// @param weights  [N, C], 0 ... 1
  KeptValues(std::int64_t num_channels, std::vector<float> values, std::vector<float> weights);

  [[nodiscard]] std::int64_t num_frames() const { return num_frames_; }
  [[nodiscard]] std::int64_t num_channels() const { return num_channels_; }
  [[nodiscard]] float weight(std::int64_t n, std::int64_t c) const { return weights_[index(n, c)]; }
  [[nodiscard]] float value(std::int64_t n, std::int64_t c) const { return values_[index(n, c)]; }
  [[nodiscard]] bool keeps(std::int64_t n, std::int64_t c) const { return weight(n, c) == 1; }
  /// Whether every channel of the frame is kept; whether none is, not even in part.
  [[nodiscard]] bool keeps_frame(std::int64_t n) const;
  [[nodiscard]] bool frees_frame(std::int64_t n) const;
  /// Frames from the first that is not kept entirely to the last; {0, 0} when all are kept.
  [[nodiscard]] FrameRange edited() const;

  /// Keeps an entry with at least this weight. @pre 0 <= weight <= 1
  void keep(std::int64_t n, std::int64_t c, float weight = 1);
  /// Keeps every frame that lies in none of the stretches, which may overlap.
  void keep_outside(std::span<const FrameRange> stretches);
  void keep_channel(std::int64_t c);
  /// Keeps an entry at a value of its own: a key set by hand.
  void set(std::int64_t n, std::int64_t c, float value);

  /// x, frame n of a diffusion that has reached `level`: known entries become their value noised to that
  /// level, weight (alpha value + sigma noise) + (1 - weight) x. Exact where the weight is 0 or 1.
  /// @param noise  [C] the noise of the start, the same at all levels; not read, and may be empty, when sigma
  /// is 0
  /// @param x      [C]
  void paste(std::int64_t n, NoiseLevel level, std::span<const float> noise, std::span<float> x) const;
  /// The same at the clean level: a frame of the result.
  void paste(std::int64_t n, std::span<float> x) const { paste(n, NoiseLevel{}, {}, x); }

 private:
  [[nodiscard]] std::size_t index(std::int64_t n, std::int64_t c) const {
    return static_cast<std::size_t>(n * num_channels_ + c);
  }
  std::int64_t num_frames_ = 0, num_channels_ = 0;
  std::vector<float> values_, weights_;  // [N, C]
};

}  // namespace mien
