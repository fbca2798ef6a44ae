#pragma once
#include "mien/tensor/aligned_floats.h"
#include "mien/tensor/tensor.h"
#include "rowwise.h"

namespace mien {

/// Keys and values of one head of an attention, packed as the weights of two products whose rows are computed
/// alone (rowwise.h).
class AttentionHead {
 public:
  /// @param keys, values  [T, d], T and d at least 1
  /// @param is_bf16       both sides of the products are rounded to bfloat16. @pre rowwise_bf16_available()
  AttentionHead(const View& keys, const View& values, bool is_bf16);
  AttentionHead() = default;

  /// out [N, T] = q k^T. @param q  [N, d]
  void scores(const View& q, float* out) const;
  /// out [N, d] = weights v, rows `stride` floats apart. @param weights  [N, T]
  void mix(const float* weights, std::int64_t num_rows, float* out, std::int64_t stride) const;

 private:
  void multiply(const View& x, const AlignedFloats& panels, std::int64_t num_columns, float* y,
                std::int64_t stride) const;
  std::int64_t num_keys_ = 0, width_ = 0;
  bool is_bf16_ = false;
  AlignedFloats keys_, values_;  ///< panels of [T, d] and of [d, T]
};

}  // namespace mien
