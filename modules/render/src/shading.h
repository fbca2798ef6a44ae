#pragma once
#include <cstdint>

#include "g_buffer.h"
#include "mien/render/rasteriser.h"
#include "projection.h"

namespace mien::render_detail {

/// Turns the reflectances of a line into light, in place. `open` (0 dark ... 1 open) has one value per
/// sample.
void shade_line(GBuffer& buffer, const Projection& projection, int y, const float* open);

/// 8-bit value of linear light by gamma 2.2, and back.
[[nodiscard]] std::uint8_t encode_gamma(float linear);
[[nodiscard]] float decode_gamma(std::uint8_t value);

/// The studio wall behind the head: a soft spot of light, a little below the middle.
[[nodiscard]] Rgb8 background_at(int x, int y, const RenderOptions& options);

/// Averages the samples of each pixel of one line of the picture and writes it.
void resolve_line(const GBuffer& buffer, int y, const RenderOptions& options, Image& picture);

}  // namespace mien::render_detail
