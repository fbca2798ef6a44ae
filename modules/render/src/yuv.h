#pragma once
#include <cstddef>
#include <cstdint>

#include "mien/render/image.h"

namespace mien::render_detail {

/// Planes of a picture with half the resolution in colour, limited range, BT.709 coefficients (ITU-R
/// BT.709-6, table 4).
struct YuvPlanes {
  std::uint8_t *luma, *blue, *red;
  int luma_stride, blue_stride, red_stride;  // bytes
};

/// Integer arithmetic, so the same on every machine. A colour sample is the mean of its 2 x 2 pixels (centre
/// siting).
/// @pre width and height are even
void to_yuv420(const Image& image, const YuvPlanes& out);

}  // namespace mien::render_detail
