#include <algorithm>

#include "attention_head.h"
#include "backends.h"
#include "elementwise_dispatch.h"
#include "mien/base/contract.h"
#include "mien/base/parallel.h"
#include "mien/tensor/ops.h"

namespace mien {
namespace {

constexpr std::int64_t kMaxBlock = 96, kMinBlock = 24;  // queries in a block, whole tiles of 6
constexpr std::int64_t kCachedScores = 8192;            // floats: most of the nearest cache

/// Queries in a block: few enough that the scores stay in the nearest cache where that is possible. Rows are
/// computed alone, so this does not show in the result.
std::int64_t block_size(std::int64_t num_keys) {
  return std::clamp(kCachedScores / num_keys / 6 * 6, kMinBlock, kMaxBlock);
}

}  // namespace

void attention(const AttentionInputs& in, float* out, int num_threads) {
  if (in.q.rows == 0) return;
  contract(in.heads >= 1 && in.q.columns % in.heads == 0 && in.k.columns == in.q.columns &&
               in.v.columns == in.q.columns && in.k.rows == in.v.rows,
           "attention: sizes of queries, keys and values do not fit");
  const std::int64_t num_keys = in.valid < 0 ? in.k.rows : std::min(in.valid, in.k.rows);
  contract(num_keys > 0, "attention: no keys");
  const std::int64_t width = in.q.columns / in.heads, stride = in.q.columns, size = block_size(num_keys);
  const std::int64_t num_blocks = (in.q.rows + size - 1) / size;
  const bool is_bf16 = in.backend == Backend::onednn_bf16 && rowwise_bf16_available();
  std::vector<AttentionHead> heads(static_cast<std::size_t>(in.heads));
  parallel_for(num_threads, in.heads, [&](std::int64_t h) {
    const View keys{in.k.data + h * width, num_keys, width, in.k.stride},
        values{in.v.data + h * width, num_keys, width, in.v.stride};
    heads[static_cast<std::size_t>(h)] = AttentionHead(keys, values, is_bf16);
  });
  const auto exp_row = elementwise::best_kernels().exp_row;
  parallel_for(num_threads, in.heads * num_blocks, [&](std::int64_t item) {
    const std::int64_t h = item / num_blocks, first = item % num_blocks * size;
    const std::int64_t count = std::min(size, in.q.rows - first);
    const AttentionHead& head = heads[static_cast<std::size_t>(h)];
    AlignedFloats scores(count * num_keys);
    float sums[kMaxBlock];
    head.scores({in.q.data + first * in.q.stride + h * width, count, width, in.q.stride}, scores.get());
    for (std::int64_t n = 0; n < count; ++n)
      sums[n] = exp_row(scores.get() + n * num_keys, num_keys, scores.get() + n * num_keys);
    float* mixed = out + first * stride + h * width;
    head.mix(scores.get(), count, mixed, stride);
    // The softmax's division, behind the product: of `width` values instead of one for each key.
    for (std::int64_t n = 0; n < count; ++n) {
      const float inverse = 1.0f / sums[n];
      for (std::int64_t i = 0; i < width; ++i) mixed[n * stride + i] *= inverse;
    }
  });
}

}  // namespace mien
