#include "occlusion.h"

#include <algorithm>
#include <cmath>

namespace mien::render_detail {
namespace {

constexpr double kGoldenAngle = 2.39996322972865332;  // radians
constexpr float kStrength = 2.4f;   // chosen by eye: lips' crease, lids and ears read at 512 pixels
constexpr float kBias = 0.03f;      // of the radius: hides the facets of coarse meshes
constexpr float kSoftness = 0.06f;  // of the radius squared: limits the weight of very near samples

}  // namespace

Occlusion::Occlusion(GBuffer& buffer, const Projection& projection, float radius, float radius_m)
    : buffer_(buffer), projection_(projection), radius_m_(radius_m) {
  for (std::size_t phase = 0; phase < offsets_.size(); ++phase)
    for (int k = 0; k < kNumSamples; ++k) {
      // A spiral with more samples near the middle; each line of four turns it by a quarter of the golden
      // angle.
      const double share = (k + 0.25 * static_cast<double>(phase) + 0.5) / kNumSamples;
      const double distance = std::max(1.0, static_cast<double>(radius) * share);
      const double angle = (k + 0.25 * static_cast<double>(phase)) * kGoldenAngle;
      offsets_[phase][static_cast<std::size_t>(k)] = {
          static_cast<int>(std::lround(distance * std::cos(angle))),
          static_cast<int>(std::lround(distance * std::sin(angle)))};
    }
  for (int x = 0; x < buffer.width; ++x)
    slope_x_.push_back((static_cast<float>(x) + 0.5f - projection.centre_x) / projection.focal);
}

void Occlusion::compute_line(int y) {
  const LineExtent extent = drawn_extent(buffer_, y);
  const int begin = extent.begin, end = extent.end;
  if (begin == end) return;
  const std::size_t row = buffer_.row(y);
  const float* depth = buffer_.depth.get() + row;
  const float *nx = buffer_.nx.get() + row, *ny = buffer_.ny.get() + row, *nz = buffer_.nz.get() + row;
  const float slope_y = (projection_.centre_y - static_cast<float>(y) - 0.5f) / projection_.focal;
  const float bias = kBias * radius_m_, softness = kSoftness * radius_m_ * radius_m_;
  float* sum = buffer_.obscurance.get() + row;
  std::fill(sum + begin, sum + end, 0.0f);
  for (const Offset& offset : offsets_[static_cast<std::size_t>(y & 3)]) {
    const int line = y + offset.dy;
    if (line < 0 || line >= buffer_.height) continue;
    const float* other = buffer_.depth.get() + buffer_.row(line) + offset.dx;
    const float* slope_x = slope_x_.data();
    const float other_slope_y = (projection_.centre_y - static_cast<float>(line) - 0.5f) / projection_.focal;
    const int dx = offset.dx, first = std::max(begin, -dx), last = std::min(end, buffer_.width - dx);
    for (int x = first; x < last; ++x) {
      const float z = other[x];
      const float vx = z * slope_x[x + dx] - depth[x] * slope_x[x];
      const float vy = z * other_slope_y - depth[x] * slope_y;
      const float vz = z - depth[x];
      const float along = vx * nx[x] + vy * ny[x] + vz * nz[x] - bias;
      sum[x] += (along > 0.0f ? along : 0.0f) / (vx * vx + vy * vy + vz * vz + softness);
    }
  }
}

void Occlusion::filtered_line(int y, float* out) const {
  const LineExtent extent = drawn_extent(buffer_, y);
  const float* depth = buffer_.depth.get() + buffer_.row(y);
  const float scale = kStrength * radius_m_ / kNumSamples, near_enough = 1.0f / (0.3f * radius_m_);
  std::vector<float> weights(static_cast<std::size_t>(buffer_.width), 0.0f);
  std::fill(out, out + buffer_.width, 0.0f);
  // Five taps with half weight at the ends: a period of four lines has the same share of every set of
  // offsets.
  for (int tap = -2; tap <= 2; ++tap) {
    const int line = y + tap;
    if (line < 0 || line >= buffer_.height) continue;
    const float tap_weight = std::abs(tap) == 2 ? 0.5f : 1.0f;
    const LineExtent other_extent = drawn_extent(buffer_, line);
    const float* other = buffer_.depth.get() + buffer_.row(line);
    const float* raw = buffer_.obscurance.get() + buffer_.row(line);
    float* weight = weights.data();
    for (int x = std::max(extent.begin, other_extent.begin); x < std::min(extent.end, other_extent.end);
         ++x) {
      const float difference = 1.0f - std::abs(other[x] - depth[x]) * near_enough;
      const float w = difference > 0.0f ? tap_weight * difference : 0.0f;
      out[x] += w * raw[x];
      weight[x] += w;
    }
  }
  for (int x = extent.begin; x < extent.end; ++x)
    out[x] = 1.0f / (1.0f + scale * out[x] / (weights[static_cast<std::size_t>(x)] + 1e-9f));
}

}  // namespace mien::render_detail
