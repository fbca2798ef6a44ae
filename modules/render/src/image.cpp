#include "mien/render/image.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"

namespace mien {

Image::Image(int width, int height, Rgb8 color) : width_(width), height_(height) {
  contract(width >= 0 && height >= 0, "Image: a negative size");
  pixels_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), color);
}

void blit(Image& target, const Image& source, int x, int y) {
  const int left = std::max(0, -x), right = std::min(source.width(), target.width() - x);
  if (left >= right) return;
  const int top = std::max(0, -y), bottom = std::min(source.height(), target.height() - y);
  for (int row = top; row < bottom; ++row)
    std::copy(source.row(row) + left, source.row(row) + right, target.row(y + row) + x + left);
}

void fill_rectangle(Image& target, int x, int y, int width, int height, Rgb8 color) {
  const int left = std::max(0, x), right = std::min(target.width(), x + width);
  if (left >= right) return;
  for (int row = std::max(0, y); row < std::min(target.height(), y + height); ++row)
    std::fill(target.row(row) + left, target.row(row) + right, color);
}

void blend_pixel(Image& target, int x, int y, Rgb8 color, float opacity) {
  if (x < 0 || y < 0 || x >= target.width() || y >= target.height()) return;
  const auto mix = [opacity](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(static_cast<float>(a) + opacity * static_cast<float>(b - a) + 0.5f);
  };
  Rgb8& p = target.at(x, y);
  p = {mix(p.r, color.r), mix(p.g, color.g), mix(p.b, color.b)};
}

void draw_line(Image& target, float x0, float y0, float x1, float y1, float thickness, Rgb8 color) {
  if (!std::isfinite(x0) || !std::isfinite(y0) || !std::isfinite(x1) || !std::isfinite(y1)) return;
  // Opacity falls from 1 to 0 over one pixel at the distance of half the thickness from the segment.
  const float reach = 0.5f * thickness + 0.5f;
  const auto clamped = [](float value, int size) {
    return static_cast<int>(std::clamp(value, -1.0f, static_cast<float>(size)));
  };
  const int left = clamped(std::floor(std::min(x0, x1) - reach), target.width());
  const int right = clamped(std::ceil(std::max(x0, x1) + reach), target.width());
  const int top = clamped(std::floor(std::min(y0, y1) - reach), target.height());
  const int bottom = clamped(std::ceil(std::max(y0, y1) + reach), target.height());
  const float dx = x1 - x0, dy = y1 - y0, squared = dx * dx + dy * dy;
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const float px = static_cast<float>(x) - x0, py = static_cast<float>(y) - y0;
      const float t = squared > 0 ? std::clamp((px * dx + py * dy) / squared, 0.0f, 1.0f) : 0.0f;
      const float ex = px - t * dx, ey = py - t * dy;
      const float opacity = std::clamp(reach - std::sqrt(ex * ex + ey * ey), 0.0f, 1.0f);
      if (opacity > 0) blend_pixel(target, x, y, color, opacity);
    }
}

}  // namespace mien
