#include <algorithm>

#include "elementwise_dispatch.h"
#include "mien/base/contract.h"
#include "mien/base/parallel.h"
#include "mien/tensor/ops.h"

namespace mien {
namespace {

// Queries in a block: many enough to use the weights of a product well, few enough that the scores of a
// minute of speech stay in the cache.
constexpr std::int64_t kBlock = 96;

/// The keys and values of one head, as the weights of two products.
struct Head {
  PackedMatrix keys;    // [T, d]
  PackedMatrix values;  // [d, T]
};

Head pack(const AttentionInputs& in, std::int64_t head, std::int64_t num_keys, std::int64_t width) {
  std::vector<float> keys(static_cast<std::size_t>(num_keys * width)), values(keys.size());
  for (std::int64_t t = 0; t < num_keys; ++t) {
    std::copy_n(in.k.data + t * in.k.stride + head * width, width, keys.data() + t * width);
    const float* v = in.v.data + t * in.v.stride + head * width;
    for (std::int64_t i = 0; i < width; ++i) values[static_cast<std::size_t>(i * num_keys + t)] = v[i];
  }
  return {PackedMatrix(keys, num_keys, width, in.backend), PackedMatrix(values, width, num_keys, in.backend)};
}

}  // namespace

void attention(const AttentionInputs& in, float* out, int num_threads) {
  if (in.q.rows == 0) return;
  contract(in.heads >= 1 && in.q.columns % in.heads == 0 && in.k.columns == in.q.columns &&
               in.v.columns == in.q.columns && in.k.rows == in.v.rows,
           "attention: sizes of queries, keys and values do not fit");
  const std::int64_t num_keys = in.valid < 0 ? in.k.rows : std::min(in.valid, in.k.rows);
  contract(num_keys > 0, "attention: no keys");
  const std::int64_t width = in.q.columns / in.heads, stride = in.q.columns;
  const std::int64_t num_blocks = (in.q.rows + kBlock - 1) / kBlock;
  std::vector<Head> heads(static_cast<std::size_t>(in.heads));
  parallel_for(num_threads, in.heads,
               [&](std::int64_t h) { heads[static_cast<std::size_t>(h)] = pack(in, h, num_keys, width); });
  const auto& kernels = elementwise::best_kernels();
  parallel_for(num_threads, in.heads * num_blocks, [&](std::int64_t item) {
    const std::int64_t h = item / num_blocks, first = item % num_blocks * kBlock;
    const std::int64_t count = std::min(kBlock, in.q.rows - first);
    const Head& head = heads[static_cast<std::size_t>(h)];
    AlignedFloats scores(count * num_keys), mixed(count * width);
    matmul({in.q.data + first * in.q.stride + h * width, count, width, in.q.stride}, head.keys, nullptr,
           scores.get());
    for (std::int64_t n = 0; n < count; ++n)
      kernels.softmax_row(scores.get() + n * num_keys, num_keys, scores.get() + n * num_keys);
    matmul({scores.get(), count, num_keys, num_keys}, head.values, nullptr, mixed.get());
    for (std::int64_t n = 0; n < count; ++n)
      std::copy_n(mixed.get() + n * width, width, out + (first + n) * stride + h * width);
  });
}

}  // namespace mien
