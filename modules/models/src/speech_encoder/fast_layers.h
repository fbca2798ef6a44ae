#pragma once
#include <functional>
#include <vector>

#include "mien/models/speech_encoder/network.h"
#include "mien/nn/plain_weights.h"
#include "mien/tensor/ops.h"

namespace mien::speech_encoder {

/// Everything after the convolutions, packed: weight norm folded into the positional convolution, the scale
/// of the queries into their weights, the three products of an attention joined. Rows go through a layer in
/// tiles that fit the cache; threads share tiles, never sums, so the bits do not depend on their number.
class FastLayers {
 public:
  /// Takes the weights out of `encoder`. The positional convolution, with its 48 outputs for 6144 inputs, and
  /// the attention products stay in float32: rounding their inputs costs what it saves.
  /// @param front   who computes the products of the projection
  /// @param layers  and those of the layers
  FastLayers(SpeechEncoder<PlainWeights>& encoder, Backend front, Backend layers);

  /// x [T, C], the convolutions' output (interpolated, if at all) -> last hidden state [T, D].
  /// @param on_hidden  called with 0 and the input of the first layer, then with i and the output of layer i
  /// - 1
  [[nodiscard]] Tensor run(Tensor x, int num_threads,
                           const std::function<void(std::int64_t, const Tensor&)>& on_hidden) const;

 private:
  struct Product {
    PackedMatrix weight;
    Tensor bias;
  };
  struct Norm {
    Tensor gamma, beta;
  };
  struct Layer {
    Product query_key_value, out, expand, contract;
    Norm attention_norm, final_norm;
  };
  [[nodiscard]] Tensor projected(Tensor x, int num_threads) const;
  /// One tile after the attention: h [n, D] and the mixed values [n, D] -> the layer's output, in h.
  void finish_layer(const Layer& layer, std::span<float> h, const View& mixed) const;
  void query_key_value(const Layer& layer, std::span<const float> h, float* out) const;

  EncoderConfig config_;
  Norm projection_norm_, norm_;
  Product projection_;
  PackedGroups positions_;
  Tensor positions_bias_;
  std::vector<Layer> layers_;
};

}  // namespace mien::speech_encoder
