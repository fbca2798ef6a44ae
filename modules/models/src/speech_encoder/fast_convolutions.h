#pragma once
#include <span>
#include <vector>

#include "mien/models/speech_encoder/network.h"
#include "mien/nn/plain_weights.h"
#include "mien/tensor/ops.h"

namespace mien::speech_encoder {

/// The seven convolutions of an encoder, packed. Rows are time, so that the window of an output is one run of
/// numbers and a convolution is a matrix product over overlapping rows, without copies.
///
/// A group norm over the clip is no second pass: a channel of the first convolution is w x for patches x, so
/// its mean and variance over time are w mu and w S w, with mean mu and covariance S of the patches. Scale
/// and shift go into the weights, and everything after it is local in time: frames are computed tile by tile
/// in bounded memory, exactly.
class FastConvolutions {
 public:
  /// Takes the weights out of `layers`. Convolutions after the first use `backend`.
  FastConvolutions(const EncoderConfig& config, std::vector<EncoderConvLayer<PlainWeights>>& layers,
                   Backend backend);

  /// The first convolution with the norm of one clip folded in: `patches` are those of its samples.
  struct First {
    PackedMatrix weight;
    Tensor bias;
  };
  [[nodiscard]] First fold(const PatchStatistics& patches) const;

  /// Frames first ... first + count - 1 of a clip -> out [count, C]. The result does not depend on the number
  /// of threads, and with Backend::rowwise not on where the tiles begin.
  void run(std::span<const float> samples, const First& first_layer, std::int64_t first, std::int64_t count,
           float* out, int num_threads) const;

 private:
  struct Layer {
    PackedMatrix weight;
    Tensor bias, norm_weight, norm_bias;
  };
  void run_tile(std::span<const float> samples, const First& first_layer, std::int64_t first,
                std::int64_t count, float* out) const;
  void finish_block(const Layer& layer, std::span<float> block) const;

  EncoderConfig config_;
  Tensor first_weight_;        ///< [C, K], before folding
  std::vector<Layer> layers_;  ///< the first one's weight is not used
};

}  // namespace mien::speech_encoder
