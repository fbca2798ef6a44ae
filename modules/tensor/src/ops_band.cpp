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
  const auto band_row = elementwise::best_kernels().band_row;
  std::vector<float> scores(static_cast<std::size_t>(heads * most));
  for (std::int64_t n = 0; n < q.rows; ++n) {
    const auto [first, end] = ranges[static_cast<std::size_t>(n)];
    band_row({.q = q.data + n * q.stride,
              .k = k.data + first * k.stride,
              .v = v.data + first * v.stride,
              .k_stride = k.stride,
              .v_stride = v.stride,
              .heads = heads,
              .width = width,
              .count = end - first,
              .scores = scores.data(),
              .out = out + n * q.columns});
  }
}

}  // namespace mien
