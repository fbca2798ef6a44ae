#pragma once
#include <memory>

#include "mien/base/result.h"
#include "mien/render/camera.h"
#include "mien/render/image.h"
#include "mien/render/scene.h"

namespace mien {

struct RenderOptions {
  int width = 512;                   ///< pixels, 1 to 8192
  int height = 512;                  ///< pixels, 1 to 8192
  int supersampling = 1;             ///< 1, or 2: four samples a pixel
  int num_threads = 1;               ///< the picture is the same for any number
  bool occlusion = true;             ///< darken creases and the inside of the mouth
  float occlusion_radius_m = 0.02f;  ///< how far an occluder reaches
  Rgb8 background_centre{218, 218, 221};
  Rgb8 background_border{168, 168, 173};

  /// Errors (Errc::usage): the first member outside of its range.
  [[nodiscard]] Status validate() const;
};

/// Memory that render() reuses from picture to picture: 36 bytes a sample and
/// about 170 a triangle. One picture at a time.
class RenderScratch {
 public:
  RenderScratch();
  RenderScratch(RenderScratch&&) noexcept;
  RenderScratch& operator=(RenderScratch&&) noexcept;
  ~RenderScratch();

  struct Buffers;
  [[nodiscard]] Buffers& buffers() { return *buffers_; }

 private:
  std::unique_ptr<Buffers> buffers_;
};

/// A picture of the scene by a software rasteriser: perspective-correct z-buffer, normals interpolated and
/// shaded per pixel, both sides of a triangle drawn, wrapped diffuse key, fill and rim light that stand with
/// the camera, hemisphere ambient light, screen-space occlusion from 14 depth samples, gamma 2.2 over a soft
/// grey background.
///
/// The same input gives the same bytes for any number of threads. Triangles that touch a position that is not
/// finite and triangles without area are left out; of two surfaces in the same place the first one is seen.
///
/// @param scratch  saves the time to get memory for a film's pictures; changes nothing else
/// @pre every surface's normals and colours have V entries or none; triangle indices are below V (checked)
/// Errors (Errc::usage): options outside of their range, e.g. a picture without pixels.
Result<Image> render(const Scene& scene, const Camera& camera, const RenderOptions& options = {},
                     RenderScratch* scratch = nullptr);

}  // namespace mien
