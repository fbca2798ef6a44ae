#pragma once
#include <string>
#include <string_view>

#include "mien/render/image.h"

namespace mien {

/// Height of a line of text and advance of a letter, in pixels at scale 1. The font has 5 x 7 dots for
/// printable ASCII.
inline constexpr int kTextHeight = 10;
inline constexpr int kTextAdvance = 6;

struct TextStyle {
  Rgb8 color{20, 20, 24};
  int scale = 1;  ///< whole number: size of a dot in pixels
};

/// Writes one line with its upper left corner at (x, y), clipped at the picture's border. A character that
/// the font lacks (also each byte outside of ASCII) shows as a box.
void draw_text(Image& target, int x, int y, std::string_view text, const TextStyle& style = {});

/// Width in pixels that draw_text needs.
[[nodiscard]] int text_width(std::string_view text, int scale = 1);

/// `text` cut to at most `width` pixels, with ".." at the end when it was cut.
[[nodiscard]] std::string fit_text(std::string_view text, int width, int scale = 1);

}  // namespace mien
