#pragma once
#include <array>
#include <cstdint>

namespace mien::render_detail {

/// One letter: 8 rows from top to bottom (the last for descenders), bit 4 = leftmost of 5 columns.
using Glyph = std::array<std::uint8_t, 8>;

/// The letter for a character; a box for one that the font lacks.
const Glyph& glyph(char c);

}  // namespace mien::render_detail
