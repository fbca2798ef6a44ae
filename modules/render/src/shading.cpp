#include "shading.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mien::render_detail {
namespace {

using Color = std::array<float, 3>;

// Lights stand with the camera, so that every view is lit alike. Directions point to the light in view space
// (right, up, away); wrap lets light reach around the edge of the shadow, most in red, as skin does.
struct Light {
  Vec3 direction;
  Color color;
  Color wrap;
};
constexpr Light kKey = {{-0.4339f, 0.4772f, -0.7642f}, {0.80f, 0.775f, 0.74f}, {0.46f, 0.32f, 0.27f}};
constexpr Light kFill = {{0.7293f, 0.0858f, -0.6788f}, {0.24f, 0.245f, 0.26f}, {0.40f, 0.40f, 0.40f}};
constexpr Light kRim = {{0.3885f, 0.4995f, 0.7743f}, {0.45f, 0.47f, 0.52f}, {0.0f, 0.0f, 0.0f}};
constexpr Color kSky = {0.40f, 0.41f, 0.43f}, kGround = {0.25f, 0.23f, 0.22f};
constexpr float kHighlight = 0.9f;  // of the key light, times the surface's gloss

constexpr int kGammaSteps = 4096;
constexpr double kGamma = 2.2;

struct GammaTables {
  std::array<std::uint8_t, kGammaSteps> encode;  // of the square root, which spreads the dark values
  std::array<float, 256> decode;
  GammaTables() {
    for (int i = 0; i < kGammaSteps; ++i) {
      const double root = static_cast<double>(i) / (kGammaSteps - 1);
      encode[static_cast<std::size_t>(i)] =
          static_cast<std::uint8_t>(std::lround(255.0 * std::pow(root, 2.0 / kGamma)));
    }
    for (std::size_t i = 0; i < decode.size(); ++i)
      decode[i] = static_cast<float>(std::pow(static_cast<double>(i) / 255.0, kGamma));
  }
};
const GammaTables& gamma_tables() {
  static const GammaTables tables;
  return tables;
}

inline std::uint8_t encoded(const GammaTables& tables, float linear) {
  const float clamped =
      linear > 0.0f ? (linear < 1.0f ? linear : 1.0f) : 0.0f;  // a value that is not a number: 0
  return tables.encode[static_cast<std::size_t>(std::sqrt(clamped) * (kGammaSteps - 1) + 0.5f)];
}

// max(v, 0) without a branch, exact.
inline float positive(float v) { return 0.5f * (v + std::abs(v)); }

inline float wrapped(float cosine, float wrap) { return positive(cosine + wrap) * (1.0f / (1.0f + wrap)); }

inline float cosine(float x, float y, float z, const Vec3& direction) {
  return x * direction.x + y * direction.y + z * direction.z;
}

// Light that falls on a matt surface in one colour, from the cosines to the key and fill light, the rim
// light, the share of sky (0 faces the ground) and the share of the surroundings that is not hidden.
template <std::size_t I>
inline float light_of(float key, float fill, float rim, float up, float crease) {
  const float ambient = kGround[I] + up * (kSky[I] - kGround[I]);
  return kKey.color[I] * wrapped(key, kKey.wrap[I]) * (0.35f + 0.65f * crease) +
         (kFill.color[I] * wrapped(fill, kFill.wrap[I]) + ambient) * crease + kRim.color[I] * rim;
}

}  // namespace

// Plain numbers, local copies and no branches, so that the loop becomes vector code.
void shade_line(GBuffer& buffer, const Projection& projection, int y, const float* open) {
  const LineExtent extent = drawn_extent(buffer, y);
  const std::size_t row = buffer.row(y);
  const float* normal_x = buffer.nx.get() + row;
  const float* normal_y = buffer.ny.get() + row;
  const float* normal_z = buffer.nz.get() + row;
  const float* gloss = buffer.gloss.get() + row;
  float* red = buffer.red.get() + row;
  float* green = buffer.green.get() + row;
  float* blue = buffer.blue.get() + row;
  const float centre_x = projection.centre_x, focal = projection.focal;
  const float view_y = (projection.centre_y - static_cast<float>(y) - 0.5f) / focal;
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC ivdep  // the planes do not overlap
#endif
  for (int x = extent.begin, end = extent.end; x < end; ++x) {
    const float nx = normal_x[x], ny = normal_y[x], nz = normal_z[x], shine = gloss[x], openness = open[x];
    // Direction to the eye. Towards the rim of a form the normal may turn away from it by interpolation.
    const float view_x = (static_cast<float>(x) + 0.5f - centre_x) / focal;
    const float view_scale = 1.0f / std::sqrt(view_x * view_x + view_y * view_y + 1.0f);
    const float ex = -view_x * view_scale, ey = -view_y * view_scale, ez = -view_scale;
    const float facing = positive(nx * ex + ny * ey + nz * ez);
    const float edge = (1.0f - facing) * (1.0f - facing);

    // Blinn's highlight: a broad lobe (exponent 16) for skin and a sharp one (128) that only wet things show.
    const float hx = kKey.direction.x + ex, hy = kKey.direction.y + ey, hz = kKey.direction.z + ez;
    const float c = positive(nx * hx + ny * hy + nz * hz);
    const float p2 = c * c / (hx * hx + hy * hy + hz * hz), p4 = p2 * p2, p8 = p4 * p4, p16 = p8 * p8;
    const float p32 = p16 * p16, p64 = p32 * p32, p128 = p64 * p64;
    const float highlight =
        kHighlight * shine * ((1.0f - shine) * 0.4f * p16 + shine * 1.2f * p128) * openness;

    const float crease = openness * (0.55f + 0.45f * openness);
    const float key = cosine(nx, ny, nz, kKey.direction), fill = cosine(nx, ny, nz, kFill.direction);
    const float rim = positive(cosine(nx, ny, nz, kRim.direction)) * edge * openness;
    const float up = 0.5f + 0.5f * ny;
    red[x] = red[x] * light_of<0>(key, fill, rim, up, crease) + highlight * kKey.color[0];
    green[x] = green[x] * light_of<1>(key, fill, rim, up, crease) + highlight * kKey.color[1];
    blue[x] = blue[x] * light_of<2>(key, fill, rim, up, crease) + highlight * kKey.color[2];
  }
}

std::uint8_t encode_gamma(float linear) { return encoded(gamma_tables(), linear); }

float decode_gamma(std::uint8_t value) { return gamma_tables().decode[value]; }

Rgb8 background_at(int x, int y, const RenderOptions& options) {
  const float w = static_cast<float>(options.width), h = static_cast<float>(options.height);
  const float dx = (static_cast<float>(x) + 0.5f - 0.5f * w) / (0.5f * w);
  const float dy = (static_cast<float>(y) + 0.5f - 0.58f * h) / (0.58f * h);
  const float squared = std::min(1.0f, 0.55f * (dx * dx + dy * dy));
  const float t = squared * (1.5f - 0.5f * squared);
  const auto mix = [t](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(static_cast<float>(a) +
                                     t * (static_cast<float>(b) - static_cast<float>(a)) + 0.5f);
  };
  const Rgb8 &c = options.background_centre, &b = options.background_border;
  return {mix(c.r, b.r), mix(c.g, b.g), mix(c.b, b.b)};
}

void resolve_line(const GBuffer& buffer, int y, const RenderOptions& options, Image& picture) {
  const int s = options.supersampling;
  const GammaTables& tables = gamma_tables();
  Rgb8* out = picture.row(y);
  for (int x = 0; x < options.width; ++x) {
    float sum[3] = {0, 0, 0};
    int drawn = 0;
    for (int sy = 0; sy < s; ++sy)
      for (int sx = 0; sx < s; ++sx) {
        const std::size_t at = buffer.row(y * s + sy) + static_cast<std::size_t>(x * s + sx);
        if (buffer.depth[at] >= kFarDepth) continue;
        ++drawn;
        // Clamped before the average: a highlight must not spread over the outline.
        sum[0] += std::min(buffer.red[at], 1.0f);
        sum[1] += std::min(buffer.green[at], 1.0f);
        sum[2] += std::min(buffer.blue[at], 1.0f);
      }
    if (drawn == 0) {
      out[x] = background_at(x, y, options);
      continue;
    }
    const float scale = 1.0f / static_cast<float>(s * s);
    if (drawn < s * s) {
      const Rgb8 wall = background_at(x, y, options);
      const auto rest = static_cast<float>(s * s - drawn);
      sum[0] += rest * tables.decode[wall.r];
      sum[1] += rest * tables.decode[wall.g];
      sum[2] += rest * tables.decode[wall.b];
    }
    out[x] = {encoded(tables, scale * sum[0]), encoded(tables, scale * sum[1]),
              encoded(tables, scale * sum[2])};
  }
}

}  // namespace mien::render_detail
