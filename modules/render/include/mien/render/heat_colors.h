#pragma once
#include <array>
#include <string_view>

#include "mien/render/image.h"

namespace mien {

/// A colour map of 256 entries from dark blue (0) over violet and orange to light yellow (255); it grows
/// lighter all the way, so it also reads in grey.
const std::array<Rgb8, 256>& heat_table();

/// The colour of `share` = value / largest value; below 0 and above 1 the ends hold, what is not a number is
/// grey.
[[nodiscard]] Rgb8 heat_color(float share);

/// The same as a linear vertex colour.
[[nodiscard]] std::array<float, 4> heat_vertex_color(float share);

/// A bar with the table from left (0) to right (`largest`, e.g. 12.5 with unit "mm") and the two numbers
/// below it. Takes `width` pixels and 24 in height.
void draw_heat_legend(Image& target, int x, int y, int width, double largest, std::string_view unit);

}  // namespace mien
