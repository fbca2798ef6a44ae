#include <algorithm>

#include "mien/tensor/ops.h"
#include "require.h"

namespace mien {

Tensor transposed(const Tensor& x) {
  require(x.rank() == 2, [&] { return "transposed: x must be [N, D], got " + shape_text(x.shape()); });
  constexpr std::int64_t kTile = 16;  // both sides of a tile stay in the cache
  const std::int64_t height = x.num_rows(), width = x.width();
  Tensor y = Tensor::uninitialized({width, height});
  for (std::int64_t r0 = 0; r0 < height; r0 += kTile)
    for (std::int64_t c0 = 0; c0 < width; c0 += kTile)
      for (std::int64_t c = c0; c < std::min(c0 + kTile, width); ++c)
        for (std::int64_t r = r0; r < std::min(r0 + kTile, height); ++r)
          y.data()[c * height + r] = x.data()[r * width + c];
  return y;
}

Tensor group_rows(const Tensor& x, std::int64_t factor) {
  require(x.rank() == 2 && factor >= 1 && x.num_rows() % factor == 0, [&] {
    return "group_rows: " + shape_text(x.shape()) + " has no whole groups of " + std::to_string(factor);
  });
  return x.reshaped({x.num_rows() / factor, factor * x.width()});
}

Tensor convolve_columns(const Tensor& x, const Tensor& taps, const Tensor& bias) {
  const std::int64_t width = x.width(), num_taps = taps.count(), reach = num_taps / 2;
  require(num_taps % 2 == 1 && bias.count() == 1, [&] {
    return "convolve_columns: an odd number of taps and one bias are needed, got " +
           shape_text(taps.shape()) + " and " + shape_text(bias.shape());
  });
  Tensor y = Tensor::uninitialized(x.shape());
  for (std::int64_t r = 0; r < x.num_rows(); ++r) {
    const float* in = x.data() + r * width;
    float* out = y.data() + r * width;
    std::fill_n(out, width, bias.data()[0]);
    for (std::int64_t j = 0; j < num_taps; ++j) {
      const std::int64_t shift = j - reach, first = std::max<std::int64_t>(0, -shift);
      const std::int64_t end = std::min(width, width - shift);
      for (std::int64_t i = first; i < end; ++i) out[i] += taps.data()[j] * in[i + shift];
    }
  }
  return y;
}

namespace {

template <class Pool>
Tensor pool_pairs(const Tensor& x, const char* name, Pool&& pool) {
  require(x.rank() >= 1 && x.width() % 2 == 0,
          [&] { return std::string(name) + ": the width of " + shape_text(x.shape()) + " is odd"; });
  Shape shape = x.shape();
  shape.back() /= 2;
  Tensor y = Tensor::uninitialized(std::move(shape));
  for (std::int64_t i = 0; i < y.count(); ++i) y.data()[i] = pool(x.data()[2 * i], x.data()[2 * i + 1]);
  return y;
}

}  // namespace

Tensor max_pool_pairs(const Tensor& x) {
  return pool_pairs(x, "max_pool_pairs",
                    [](float a, float b) { return a > b || a != a ? a : b; });  // NaN passes
}

Tensor mean_pool_pairs(const Tensor& x) {
  return pool_pairs(x, "mean_pool_pairs", [](float a, float b) { return 0.5f * (a + b); });
}

}  // namespace mien
