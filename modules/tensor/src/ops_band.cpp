#include <algorithm>
#include <vector>

#include "elementwise_dispatch.h"
#include "mien/base/contract.h"
#include "mien/tensor/ops.h"

namespace mien {

void attention_within(const View& q, const View& k, const View& v, std::int64_t heads,
                      std::span<const KeyRange> ranges, float* out) {
  contract(heads >= 1 && q.columns % heads == 0 && k.columns == q.columns && v.columns == q.columns &&
               k.rows == v.rows && static_cast<std::int64_t>(ranges.size()) == q.rows,
           "attention_within: sizes of queries, keys, values and ranges do not fit");
  const std::int64_t width = q.columns / heads;
  std::int64_t most = 0;
  for (const KeyRange& range : ranges) {
    contract(range.first >= 0 && range.first < range.end && range.end <= k.rows,
             "attention_within: a range holds no keys, or keys that are not there");
    most = std::max(most, range.end - range.first);
  }
  const auto& kernels = elementwise::best_kernels();
  std::vector<float> weights(static_cast<std::size_t>(most));
  for (std::int64_t n = 0; n < q.rows; ++n) {
    const auto [first, end] = ranges[static_cast<std::size_t>(n)];
    for (std::int64_t h = 0; h < heads; ++h) {
      const float* query = q.data + n * q.stride + h * width;
      float* mixed = out + n * q.columns + h * width;
      for (std::int64_t t = first; t < end; ++t) {
        const float* key = k.data + t * k.stride + h * width;
        float sum = 0;
        for (std::int64_t i = 0; i < width; ++i) sum += query[i] * key[i];
        weights[static_cast<std::size_t>(t - first)] = sum;
      }
      kernels.softmax_row(weights.data(), end - first, weights.data());
      std::fill_n(mixed, width, 0.0f);
      for (std::int64_t t = first; t < end; ++t) {
        const float weight = weights[static_cast<std::size_t>(t - first)];
        const float* value = v.data + t * v.stride + h * width;
        for (std::int64_t i = 0; i < width; ++i) mixed[i] += weight * value[i];
      }
    }
  }
}

}  // namespace mien
