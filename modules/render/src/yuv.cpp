#include "yuv.h"

namespace mien::render_detail {
namespace {

constexpr int kBits = 16;

constexpr int scaled(double share, double range) {
  const double value = share * range / 255 * (1 << kBits);
  return static_cast<int>(value < 0 ? value - 0.5 : value + 0.5);
}

constexpr double kRed = 0.2126, kGreen = 0.7152, kBlue = 0.0722;
constexpr int kLuma[3] = {scaled(kRed, 219), scaled(kGreen, 219), scaled(kBlue, 219)};
// B - Y and R - Y, scaled to half of the range on both sides.
constexpr int kCb[3] = {scaled(-kRed / (2 * (1 - kBlue)), 224), scaled(-kGreen / (2 * (1 - kBlue)), 224),
                        scaled(0.5, 224)};
constexpr int kCr[3] = {scaled(0.5, 224), scaled(-kGreen / (2 * (1 - kRed)), 224),
                        scaled(-kBlue / (2 * (1 - kRed)), 224)};

constexpr int weigh(const int (&c)[3], int r, int g, int b) { return c[0] * r + c[1] * g + c[2] * b; }

}  // namespace

void to_yuv420(const Image& image, const YuvPlanes& out) {
  constexpr int half = 1 << (kBits - 1);
  for (int y = 0; y < image.height(); ++y) {
    const Rgb8* row = image.row(y);
    std::uint8_t* luma = out.luma + static_cast<std::ptrdiff_t>(y) * out.luma_stride;
    for (int x = 0; x < image.width(); ++x)
      luma[x] =
          static_cast<std::uint8_t>(16 + ((weigh(kLuma, row[x].r, row[x].g, row[x].b) + half) >> kBits));
  }
  for (int y = 0; y < image.height() / 2; ++y) {
    const Rgb8 *top = image.row(2 * y), *bottom = image.row(2 * y + 1);
    std::uint8_t* cb = out.blue + static_cast<std::ptrdiff_t>(y) * out.blue_stride;
    std::uint8_t* cr = out.red + static_cast<std::ptrdiff_t>(y) * out.red_stride;
    for (int x = 0; x < image.width() / 2; ++x) {
      const Rgb8 &a = top[2 * x], &b = top[2 * x + 1], &c = bottom[2 * x], &d = bottom[2 * x + 1];
      const int red = a.r + b.r + c.r + d.r, green = a.g + b.g + c.g + d.g, blue = a.b + b.b + c.b + d.b;
      cb[x] =
          static_cast<std::uint8_t>(128 + ((weigh(kCb, red, green, blue) + 2 * (1 << kBits)) >> (kBits + 2)));
      cr[x] =
          static_cast<std::uint8_t>(128 + ((weigh(kCr, red, green, blue) + 2 * (1 << kBits)) >> (kBits + 2)));
    }
  }
}

}  // namespace mien::render_detail
