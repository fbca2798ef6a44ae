#include "fast_convolutions.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/base/parallel.h"
#include "mien/tensor/in_place.h"

namespace mien::speech_encoder {
namespace {

// Frames of a tile: 2 000 rows of the first convolution, a few MB for each thread.
constexpr std::int64_t kTileFrames = 32;
// Rows of one product: inputs and a group of weight columns stay in the second-level cache.
constexpr std::int64_t kBlockRows = 96;

std::span<float> rows_of(float* data, std::int64_t first, std::int64_t count, std::int64_t width) {
  return {data + first * width, static_cast<std::size_t>(count * width)};
}

}  // namespace

FastConvolutions::FastConvolutions(const EncoderConfig& config,
                                   std::vector<EncoderConvLayer<PlainWeights>>& layers, Backend backend)
    : config_(config) {
  for (auto& from : layers) {
    Layer layer{{}, std::move(from.bias), std::move(from.norm_weight), std::move(from.norm_bias)};
    const Tensor weight = tap_major(from.weight);
    if (layers_.empty())
      first_weight_ = weight;
    else
      layer.weight = PackedMatrix(weight, backend);
    from.weight = {};
    layers_.push_back(std::move(layer));
  }
}

FastConvolutions::First FastConvolutions::fold(const PatchStatistics& s) const {
  if (config_.conv_layer_norm) return {PackedMatrix(first_weight_), layers_[0].bias};
  const std::int64_t channels = config_.conv_dim[0];
  Tensor weight = first_weight_;
  Tensor bias({channels});
  for (std::int64_t c = 0; c < channels; ++c) {
    const std::span<float> w = weight.row(c);
    double mean = 0, variance = 0;  // a bias of the convolution moves the mean and is taken away with it
    for (std::size_t j = 0; j < w.size(); ++j) {
      mean += w[j] * s.mean[j];
      for (std::size_t k = 0; k < w.size(); ++k)
        variance += static_cast<double>(w[j]) * w[k] * s.covariance[j * w.size() + k];
    }
    const double scale = layers_[0].norm_weight.data()[c] / std::sqrt(std::max(variance, 0.0) + kConvNormEps);
    for (float& v : w) v = static_cast<float>(v * scale);
    bias.data()[c] = static_cast<float>(layers_[0].norm_bias.data()[c] - mean * scale);
  }
  return {PackedMatrix(weight), std::move(bias)};
}

void FastConvolutions::finish_block(const Layer& layer, std::span<float> block) const {
  if (config_.conv_layer_norm)
    layer_norm_in_place(block, {}, layer.norm_weight, layer.norm_bias, kConvNormEps);
  gelu_in_place(block);
}

void FastConvolutions::run_tile(std::span<const float> samples, const First& first_layer, std::int64_t first,
                                std::int64_t count, float* out) const {
  const std::size_t num_layers = layers_.size();
  std::vector<std::int64_t> rows(num_layers, count);  // outputs of each layer that the tile needs
  for (std::size_t i = num_layers - 1; i > 0; --i)
    rows[i - 1] = (rows[i] - 1) * config_.conv_stride[i] + config_.conv_kernel[i];
  Tensor x;
  const float* from = samples.data() + first * config_.hop();
  std::int64_t width = 1;
  for (std::size_t i = 0; i < num_layers; ++i) {
    const Layer& layer = layers_[i];
    const std::int64_t kernel = config_.conv_kernel[i], stride = config_.conv_stride[i],
                       channels = config_.conv_dim[i];
    const PackedMatrix& weight = i == 0 ? first_layer.weight : layer.weight;
    const Tensor& bias = i == 0 ? first_layer.bias : layer.bias;
    const bool last = i + 1 == num_layers;
    Tensor next = last ? Tensor() : Tensor::uninitialized({rows[i], channels});
    float* to = last ? out : next.data();
    for (std::int64_t r = 0; r < rows[i]; r += kBlockRows) {
      const std::int64_t block = std::min(kBlockRows, rows[i] - r);
      matmul({from + r * stride * width, block, kernel * width, stride * width}, weight,
             bias.count() == 0 ? nullptr : bias.data(), to + r * channels);
      finish_block(layer, rows_of(to, r, block, channels));
    }
    x = std::move(next);
    from = x.data();
    width = channels;
  }
}

void FastConvolutions::run(std::span<const float> samples, const First& first_layer, std::int64_t first,
                           std::int64_t count, float* out, int num_threads) const {
  contract(first >= 0 && first + count <= config_.num_frames(static_cast<std::int64_t>(samples.size())),
           "FastConvolutions: frames outside the clip");
  const std::int64_t num_tiles = (count + kTileFrames - 1) / kTileFrames;
  parallel_for(num_threads, num_tiles, [&](std::int64_t tile) {
    const std::int64_t begin = tile * kTileFrames, size = std::min(kTileFrames, count - begin);
    run_tile(samples, first_layer, first + begin, size, out + begin * config_.conv_dim.back());
  });
}

}  // namespace mien::speech_encoder
