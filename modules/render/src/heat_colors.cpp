#include "mien/render/heat_colors.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "mien/base/number_text.h"
#include "mien/render/text.h"
#include "shading.h"

namespace mien {
namespace {

constexpr int kNumAnchors = 7;
// Evenly spaced along the table.
constexpr Rgb8 kAnchors[kNumAnchors] = {{14, 16, 64},   {72, 22, 122},  {140, 36, 132}, {200, 58, 104},
                                        {238, 104, 66}, {250, 168, 66}, {252, 246, 184}};
constexpr Rgb8 kUndefined = {128, 128, 128};

}  // namespace

const std::array<Rgb8, 256>& heat_table() {
  static const std::array<Rgb8, 256> table = [] {
    std::array<Rgb8, 256> t;
    for (int i = 0; i < 256; ++i) {
      const int scaled = i * (kNumAnchors - 1), left = std::min(scaled / 255, kNumAnchors - 2),
                rest = scaled - 255 * left;
      const auto mix = [rest](int a, int b) {
        return static_cast<std::uint8_t>((a * (255 - rest) + b * rest + 127) / 255);
      };
      const Rgb8 &a = kAnchors[left], &b = kAnchors[left + 1];
      t[static_cast<std::size_t>(i)] = {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
    }
    return t;
  }();
  return table;
}

Rgb8 heat_color(float share) {
  if (std::isnan(share)) return kUndefined;
  const float clamped = share > 0 ? (share < 1 ? share : 1.0f) : 0.0f;
  return heat_table()[static_cast<std::size_t>(clamped * 255.0f + 0.5f)];
}

std::array<float, 4> heat_vertex_color(float share) {
  const Rgb8 c = heat_color(share);
  using render_detail::decode_gamma;
  return {decode_gamma(c.r), decode_gamma(c.g), decode_gamma(c.b), 1};
}

void draw_heat_legend(Image& target, int x, int y, int width, double largest, std::string_view unit) {
  for (int i = 0; i < width; ++i)
    fill_rectangle(target, x + i, y, 1, 12,
                   heat_color(static_cast<float>(i) / static_cast<float>(std::max(1, width - 1))));
  const std::string right = fixed(largest, largest < 10 ? 2 : 1) + " " + std::string(unit);
  draw_text(target, x, y + 13, "0");
  draw_text(target, x + width - text_width(right), y + 13, right);
}

}  // namespace mien
