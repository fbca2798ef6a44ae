#pragma once
#include <cstddef>
#include <memory>

namespace mien::render_detail {

/// Depth where nothing was drawn, metres.
inline constexpr float kFarDepth = 1e6f;

/// What is seen at each sample, one plane per number. Planes are not initialised: the tiles write every
/// sample.
struct GBuffer {
  /// Takes the size; memory is kept when it is large enough.
  void reshape(int columns, int lines) {
    width = columns, height = lines;
    const std::size_t count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(lines);
    if (count <= capacity) return;
    for (std::unique_ptr<float[]>* plane : {&depth, &nx, &ny, &nz, &red, &green, &blue, &gloss, &obscurance})
      plane->reset(new float[count]);
    capacity = count;
  }
  [[nodiscard]] std::size_t row(int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }

  int width = 0, height = 0;
  std::size_t capacity = 0;
  std::unique_ptr<float[]> depth;             // along the view axis, metres; kFarDepth = background
  std::unique_ptr<float[]> nx, ny, nz;        // unit normal in view space: right, up, away from the camera
  std::unique_ptr<float[]> red, green, blue;  // linear reflectance; after shading, linear light
  std::unique_ptr<float[]> gloss;
  std::unique_ptr<float[]> obscurance;  // see occlusion.h; only written where something was drawn
};

/// First and one past the last column of a line where something was drawn; equal when nothing was.
struct LineExtent {
  int begin = 0, end = 0;
};
inline LineExtent drawn_extent(const GBuffer& buffer, int y) {
  const float* depth = buffer.depth.get() + buffer.row(y);
  LineExtent extent{0, buffer.width};
  while (extent.begin < extent.end && depth[extent.begin] >= kFarDepth) ++extent.begin;
  while (extent.end > extent.begin && depth[extent.end - 1] >= kFarDepth) --extent.end;
  return extent;
}

}  // namespace mien::render_detail
