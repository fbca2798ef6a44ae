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

inline float positive(float v) { return v > 0.0f ? v : 0.0f; }

inline float wrapped(float cosine, float wrap) { return positive(cosine + wrap) * (1.0f / (1.0f + wrap)); }

// How the lights meet a sample; the same for all three colours.
struct Incidence {
  float key, fill;  // cosines
  float up;         // 0 faces the ground, 1 the sky
  float rim;
  float crease;  // share of the surroundings that is not hidden
};

// Light that falls on a matt surface in one colour. A template, because the compiler gives up on vector code
// for a loop over colours.
template <std::size_t I>
inline float light_of(const Incidence& in) {
  const float ambient = kGround[I] + in.up * (kSky[I] - kGround[I]);
  return kKey.color[I] * wrapped(in.key, kKey.wrap[I]) * (0.35f + 0.65f * in.crease) +
         (kFill.color[I] * wrapped(in.fill, kFill.wrap[I]) + ambient) * in.crease + kRim.color[I] * in.rim;
}

}  // namespace

void shade_line(GBuffer& buffer, const Projection& projection, int y, const float* open) {
  const LineExtent extent = drawn_extent(buffer, y);
  const std::size_t row = buffer.row(y);
  const float *nx = buffer.nx.get() + row, *ny = buffer.ny.get() + row, *nz = buffer.nz.get() + row;
  const float* gloss = buffer.gloss.get() + row;
  float *red = buffer.red.get() + row, *green = buffer.green.get() + row, *blue = buffer.blue.get() + row;
  const float view_y = (projection.centre_y - static_cast<float>(y) - 0.5f) / projection.focal;
  for (int x = extent.begin; x < extent.end; ++x) {
    const Vec3 n{nx[x], ny[x], nz[x]};
    // Direction to the eye. Towards the rim of a form the normal may turn away from it by interpolation.
    const float view_x = (static_cast<float>(x) + 0.5f - projection.centre_x) / projection.focal;
    const float view_scale = 1.0f / std::sqrt(view_x * view_x + view_y * view_y + 1.0f);
    const Vec3 eye{-view_x * view_scale, -view_y * view_scale, -view_scale};
    const float facing = positive(dot(n, eye));

    const float key = dot(n, kKey.direction), fill = dot(n, kFill.direction), rim = dot(n, kRim.direction);
    const float edge = (1.0f - facing) * (1.0f - facing);

    const Vec3 half = kKey.direction + eye;
    const float half_squared = dot(half, half);
    const float c = positive(dot(n, half));
    // Blinn's highlight: a broad lobe (exponent 16) for skin and a sharp one (128) that only wet things show.
    const float p2 = c * c / half_squared, p4 = p2 * p2, p8 = p4 * p4, p16 = p8 * p8, p32 = p16 * p16;
    const float p64 = p32 * p32, p128 = p64 * p64;
    const float highlight =
        kHighlight * gloss[x] * ((1.0f - gloss[x]) * 0.4f * p16 + gloss[x] * 1.2f * p128) * open[x];

    const float crease = open[x] * (0.55f + 0.45f * open[x]);
    const Incidence in{key, fill, 0.5f + 0.5f * n.y, positive(rim) * edge * open[x], crease};
    red[x] = red[x] * light_of<0>(in) + highlight * kKey.color[0];
    green[x] = green[x] * light_of<1>(in) + highlight * kKey.color[1];
    blue[x] = blue[x] * light_of<2>(in) + highlight * kKey.color[2];
  }
}

std::uint8_t encode_gamma(float linear) {
  const float clamped =
      linear > 0.0f ? (linear < 1.0f ? linear : 1.0f) : 0.0f;  // a value that is not a number: 0
  return gamma_tables().encode[static_cast<std::size_t>(std::sqrt(clamped) * (kGammaSteps - 1) + 0.5f)];
}

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
      sum[0] += rest * decode_gamma(wall.r);
      sum[1] += rest * decode_gamma(wall.g);
      sum[2] += rest * decode_gamma(wall.b);
    }
    out[x] = {encode_gamma(scale * sum[0]), encode_gamma(scale * sum[1]), encode_gamma(scale * sum[2])};
  }
}

}  // namespace mien::render_detail
