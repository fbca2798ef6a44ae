#include "mien/render/text.h"

#include <algorithm>

#include "font.h"
#include "mien/base/contract.h"

namespace mien {

void draw_text(Image& target, int x, int y, std::string_view text, const TextStyle& style) {
  contract(style.scale >= 1, "draw_text: the scale must be at least 1");
  for (const char c : text) {
    const render_detail::Glyph& rows = render_detail::glyph(c);
    for (int row = 0; row < static_cast<int>(rows.size()); ++row)
      for (int column = 0; column < 5; ++column)
        if ((rows[static_cast<std::size_t>(row)] >> (4 - column) & 1) != 0)
          fill_rectangle(target, x + column * style.scale, y + (row + 1) * style.scale, style.scale,
                         style.scale, style.color);
    x += kTextAdvance * style.scale;
  }
}

int text_width(std::string_view text, int scale) {
  return static_cast<int>(text.size()) * kTextAdvance * scale;
}

std::string fit_text(std::string_view text, int width, int scale) {
  const auto room = static_cast<std::size_t>(std::max(0, width / (kTextAdvance * scale)));
  if (text.size() <= room) return std::string(text);
  if (room < 3) return std::string(text.substr(0, room));
  return std::string(text.substr(0, room - 2)) + "..";
}

}  // namespace mien
