#pragma once
#include <cstdint>
#include <vector>

namespace mien {

/// A colour for the screen: gamma-encoded, 8 bits a channel.
struct Rgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// A picture in memory: rows from top to bottom, pixels from left to right.
class Image {
 public:
  Image() = default;
  /// Filled with one colour. @pre width and height are not negative
  Image(int width, int height, Rgb8 color = {});

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] bool empty() const { return pixels_.empty(); }
  /// @pre 0 <= x < width, 0 <= y < height
  [[nodiscard]] Rgb8& at(int x, int y) { return pixels_[index(x, y)]; }
  [[nodiscard]] Rgb8 at(int x, int y) const { return pixels_[index(x, y)]; }
  /// First pixel of a row; the others follow.
  [[nodiscard]] Rgb8* row(int y) { return pixels_.data() + index(0, y); }
  [[nodiscard]] const Rgb8* row(int y) const { return pixels_.data() + index(0, y); }

  friend bool operator==(const Image&, const Image&) = default;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  int width_ = 0, height_ = 0;
  std::vector<Rgb8> pixels_;  // [height, width]
};

/// Copies `source` with its upper left corner at (x, y); what falls outside of `target` is left out.
void blit(Image& target, const Image& source, int x, int y);

/// Fills a rectangle; what falls outside is left out.
void fill_rectangle(Image& target, int x, int y, int width, int height, Rgb8 color);

/// Mixes `color` over a pixel: opacity 0 leaves it, 1 replaces it. Outside of the picture nothing happens.
void blend_pixel(Image& target, int x, int y, Rgb8 color, float opacity);

/// A smooth line of about `thickness` pixels; coordinates are pixel centres. Points that are not finite draw
/// nothing.
void draw_line(Image& target, float x0, float y0, float x1, float y1, float thickness, Rgb8 color);

}  // namespace mien
