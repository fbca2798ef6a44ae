#pragma once
#include <cstdint>
#include <span>

#include "mien/base/random.h"

namespace mien {

/// Standard normal noise of one animation, addressed by place: what is asked for does not depend on the order
/// of asking, so a sampler may work frame by frame, step by step or along a wavefront. Recorded noise replays
/// through the same interface. Safe from many threads.
class FrameNoise {
 public:
  virtual ~FrameNoise() = default;
  /// The noise that sampling starts from, at a frame.
  virtual void start(std::int64_t frame, std::span<float> out) const = 0;
  /// Fresh noise of a sampler step (0 is the first), at a frame.
  virtual void step(int step, std::int64_t frame, std::span<float> out) const = 0;
};

/// Noise of a seed. `width` is the number of values a frame; equal seeds and widths give equal noise.
class SeededFrameNoise final : public FrameNoise {
 public:
  /// @param same_for_all_frames  fresh noise of a step is one vector for the whole animation ("const noise");
  ///                             the start is not
  SeededFrameNoise(std::uint64_t seed, std::uint32_t stream, std::int64_t width,
                   bool same_for_all_frames = false)
      : field_(seed, stream), width_(static_cast<std::uint64_t>(width)), same_(same_for_all_frames) {}
  void start(std::int64_t frame, std::span<float> out) const override {
    field_.normal(static_cast<std::uint64_t>(frame) * width_, 0, out);
  }
  void step(int step, std::int64_t frame, std::span<float> out) const override {
    field_.normal(same_ ? 0 : static_cast<std::uint64_t>(frame) * width_,
                  static_cast<std::uint32_t>(step) + 1, out);
  }

 private:
  NoiseField field_;
  std::uint64_t width_;
  bool same_;
};

}  // namespace mien
