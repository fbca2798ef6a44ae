#include "mien/render/rasteriser.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "g_buffer.h"
#include "mien/base/parallel.h"
#include "occlusion.h"
#include "projection.h"
#include "shading.h"
#include "tiles.h"

namespace mien {
namespace {

using namespace render_detail;

constexpr int kMaxRasterSide = 8192;
constexpr int kBand = 8;  // lines handed to a thread at a time

void check(const Scene& scene) {
  for (const SceneSurface& s : scene.surfaces) {
    contract(s.normals.empty() || s.normals.size() == s.positions.size(),
             "render: one normal per vertex expected");
    contract(s.colors.empty() || s.colors.size() == s.positions.size(),
             "render: one colour per vertex expected");
    for (const auto& triangle : s.triangles)
      for (const std::uint32_t v : triangle)
        contract(v < s.positions.size(), "render: a triangle names a vertex that is not there");
  }
}

void for_lines(int num_threads, int lines, const std::function<void(int)>& body) {
  parallel_for(num_threads, (lines + kBand - 1) / kBand, [&](std::int64_t band) {
    const int first = static_cast<int>(band) * kBand;
    for (int y = first; y < std::min(lines, first + kBand); ++y) body(y);
  });
}

}  // namespace

struct RenderScratch::Buffers {
  ViewVertices vertices;
  std::vector<Triangle> triangles;
  GBuffer samples;
};
RenderScratch::RenderScratch() : buffers_(std::make_unique<Buffers>()) {}
RenderScratch::RenderScratch(RenderScratch&&) noexcept = default;
RenderScratch& RenderScratch::operator=(RenderScratch&&) noexcept = default;
RenderScratch::~RenderScratch() = default;

Status RenderOptions::validate() const {
  const auto side = [](const char* name, int value) -> Status {
    if (value >= 1 && value <= kMaxRasterSide) return Done{};
    return Error{Errc::usage, std::string("picture ") + name,
                 "is " + std::to_string(value) + " pixels, expected 1 to " + std::to_string(kMaxRasterSide),
                 ""};
  };
  MIEN_TRY([[maybe_unused]] const auto width_fits, side("width", width));
  MIEN_TRY([[maybe_unused]] const auto height_fits, side("height", height));
  if (supersampling < 1 || supersampling > 2)
    return Error{Errc::usage, "supersampling", "is " + std::to_string(supersampling) + ", expected 1 or 2",
                 ""};
  if (!(occlusion_radius_m > 0) || !std::isfinite(occlusion_radius_m))
    return Error{Errc::usage, "occlusion radius", "must be a positive number of metres", ""};
  return Done{};
}

Result<Image> render(const Scene& scene, const Camera& camera, const RenderOptions& options,
                     RenderScratch* scratch) {
  MIEN_TRY([[maybe_unused]] const auto valid, options.validate());
  check(scene);
  RenderScratch own;
  RenderScratch::Buffers& memory = (scratch != nullptr ? scratch : &own)->buffers();
  ViewVertices& vertices = memory.vertices;
  std::vector<Triangle>& triangles = memory.triangles;
  GBuffer& buffer = memory.samples;
  const int scale = options.supersampling, width = options.width * scale, height = options.height * scale;
  const Projection projection = make_projection(camera, width, height);
  to_view(scene, projection, options.num_threads, vertices);
  set_up_triangles(scene, vertices, projection, width, height, options.num_threads, triangles);
  const TileBins bins = bin_triangles(triangles, width, height);
  buffer.reshape(width, height);
  parallel_for(options.num_threads, static_cast<std::int64_t>(bins.columns) * bins.rows,
               [&](std::int64_t tile) {
                 draw_tile(scene, vertices, triangles, bins, static_cast<int>(tile), buffer);
               });

  const float distance = length(camera.target - camera.position);
  const float radius = distance > 0 ? options.occlusion_radius_m * projection.focal / distance : 0.0f;
  const bool occludes = options.occlusion && radius >= 1;
  Occlusion occlusion(buffer, projection, std::min(radius, static_cast<float>(width + height)),
                      options.occlusion_radius_m);
  if (occludes) for_lines(options.num_threads, height, [&](int y) { occlusion.compute_line(y); });

  Image picture(options.width, options.height);
  for_lines(options.num_threads, options.height, [&](int y) {
    std::vector<float> open(static_cast<std::size_t>(width), 1.0f);
    for (int line = y * scale; line < (y + 1) * scale; ++line) {
      if (occludes) occlusion.filtered_line(line, open.data());
      shade_line(buffer, projection, line, open.data());
    }
    resolve_line(buffer, y, options, picture);
  });
  return picture;
}

}  // namespace mien
