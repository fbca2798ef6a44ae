#pragma once
#include <array>
#include <vector>

#include "g_buffer.h"
#include "projection.h"

namespace mien::render_detail {

/// Ambient obscurance from the depth buffer after McGuire, Osman, Bukowski and Hennessy, "The Alchemy
/// screen-space ambient obscurance algorithm", 2011: the mean over samples q around p of max(0, n.(q - p)) /
/// |q - p|^2. Samples stand at fixed offsets (the radius is taken at the camera's target), so that a line of
/// the picture is computed by straight loops; every fourth line has the same offsets, and a vertical filter
/// over four lines joins them.
class Occlusion {
 public:
  static constexpr int kNumSamples = 14;

  /// `radius` in samples of the picture at the target's depth, `radius_m` the same in metres.
  Occlusion(GBuffer& buffer, const Projection& projection, float radius, float radius_m);

  /// First step, per line: fills the line of GBuffer::obscurance. Lines are independent.
  void compute_line(int y);
  /// Second step, after all lines: what reaches the samples of a line, 0 (dark) to 1 (open). `out` has
  /// `width` values.
  void filtered_line(int y, float* out) const;

 private:
  struct Offset {
    int dx, dy;
  };
  GBuffer& buffer_;
  const Projection& projection_;
  float radius_m_;
  std::array<std::array<Offset, kNumSamples>, 4> offsets_;
  std::vector<float> slope_x_;  // [width] x / depth of each column
};

}  // namespace mien::render_detail
