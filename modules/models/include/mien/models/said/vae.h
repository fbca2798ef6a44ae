#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/io/safetensors.h"
#include "mien/nn/batch_norm.h"
#include "mien/nn/layers.h"

// The variational auto-encoder with which SAiD's authors compare motion (specification of SAiD, section 8.1):
// windows of coefficients [W, K] to a Gaussian over codes [L], and codes back to windows. Names are those of
// vae.pth. Tensors are
// [.., W, K]; a code is one row [.., 1, L].
namespace mien::said {

struct VaeConvSizes {
  std::int64_t in = 0, out = 0, kernel = 3;
};

/// As released. The steps of the convolutions over time are part of the design, not of the weights.
struct VaeSizes {
  std::int64_t window = 120;   ///< W, frames
  std::int64_t channels = 32;  ///< K
  std::int64_t latent = 64;    ///< L
  std::array<VaeConvSizes, 4> encoder_convs = {{{32, 32, 3}, {32, 64, 3}, {64, 64, 4}, {64, 32, 3}}};
  std::array<std::int64_t, 3> encoder_widths = {256, 128, 64};
  std::int64_t decoder_width = 240;
  std::array<VaeConvSizes, 4> decoder_convs = {{{4, 32, 3}, {32, 32, 3}, {32, 32, 3}, {32, 32, 3}}};

  static constexpr std::array<std::int64_t, 4> kEncoderSteps = {1, 1, 2, 1};
  /// Frames that the encoder's convolutions leave of a window.
  [[nodiscard]] std::int64_t encoded_frames() const;
  /// Numbers that they leave: the width of the first linear layer.
  [[nodiscard]] std::int64_t flat_width() const { return encoded_frames() * encoder_convs.back().out; }
  /// Frames that the decoder's convolutions begin with, so that they end with a window.
  [[nodiscard]] std::int64_t seed_frames() const;
};

/// Read from the shapes of the stored tensors. Errors (Errc::incompatible): not such weights, or layers that
/// do not follow on each other.
Result<VaeSizes> vae_sizes_of(const std::map<std::string, Shape>& shapes);
Result<VaeSizes> vae_sizes_of(const SafetensorsFile& file);

/// Slopes of the leaky rectifiers behind convolutions and behind linear layers.
inline constexpr float kConvSlope = 0.2f, kDenseSlope = 0.01f;

template <class T>
struct VaeConv {
  VaeConvSizes size;
  std::int64_t step = 1;
  typename Operations<T>::Matrix weight{};
  T bias{};
  template <class V>
  void visit(V& v) {
    v.convolution("weight", weight, size.out, size.in, size.kernel, Init::fan_in);
    v.tensor("bias", bias, Shape{size.out}, Init::fan_in);
  }
  T operator()(const T& x) const { return Operations<T>::conv(x, weight, bias, size.kernel, step); }
};

template <class T>
struct VaeTransposedConv {
  VaeConvSizes size;
  T weight{}, bias{};
  template <class V>
  void visit(V& v) {
    v.tensor("weight", weight, Shape{size.in, size.out, size.kernel}, Init::fan_in);
    v.tensor("bias", bias, Shape{size.out}, Init::fan_in);
  }
  T operator()(const T& x) const { return ChannelOperations<T>::transposed_conv(x, weight, bias); }
};

template <class T>
struct VaeEncoder {
  VaeSizes sizes;
  std::vector<VaeConv<T>> convs;
  std::vector<BatchNorm<T>> conv_norms, dense_norms;  ///< behind all but the last
  std::vector<Linear<T>> dense;
  Linear<T> mean, log_variance;

  explicit VaeEncoder(const VaeSizes& s)
      : sizes(s), mean{s.encoder_widths.back(), s.latent}, log_variance{s.encoder_widths.back(), s.latent} {
    std::int64_t width = s.flat_width();
    for (std::size_t i = 0; i < s.encoder_convs.size(); ++i) {
      convs.push_back({s.encoder_convs[i], VaeSizes::kEncoderSteps[i]});
      if (i + 1 < s.encoder_convs.size()) conv_norms.push_back({s.encoder_convs[i].out});
    }
    for (std::size_t i = 0; i < s.encoder_widths.size(); ++i) {
      dense.push_back({width, s.encoder_widths[i]});
      width = s.encoder_widths[i];
      if (i + 1 < s.encoder_widths.size()) dense_norms.push_back({width});
    }
  }

  // The numbers count the layers of the authors' lists: convolution or linear map, norm, rectifier, and
  // again.
  template <class V>
  void visit(V& v) {
    const auto stack = [&](const std::string& name, auto& layers, auto& norms) {
      for (std::size_t i = 0; i < layers.size(); ++i) {
        v.scope(name + "." + std::to_string(3 * i), layers[i]);
        if (i < norms.size()) v.scope(name + "." + std::to_string(3 * i + 1), norms[i]);
      }
    };
    stack("conv_layers", convs, conv_norms);
    stack("fc_layers", dense, dense_norms);
    v.scope("fc_mu", mean);
    v.scope("fc_logvar", log_variance);
  }

  /// Windows [.., W, K] -> [.., 1, flat_width()], channel by channel.
  template <class Norm = MeasuredStatistics<T>>
  T flattened(T x, const Norm& norm = {}) const {
    using C = ChannelOperations<T>;
    for (std::size_t i = 0; i < convs.size(); ++i) {
      x = convs[i](x);
      if (i < conv_norms.size()) x = C::leaky_relu(norm(conv_norms[i], std::move(x)), kConvSlope);
    }
    return C::channel_runs(x, sizes.flat_width());
  }
  /// [.., rows, flat_width()] -> [.., rows, the last of encoder_widths], row by row.
  template <class Norm = MeasuredStatistics<T>>
  T hidden(T x, const Norm& norm = {}) const {
    using C = ChannelOperations<T>;
    for (std::size_t i = 0; i < dense.size(); ++i) {
      x = dense[i](x);
      if (i < dense_norms.size()) x = C::leaky_relu(norm(dense_norms[i], std::move(x)), kDenseSlope);
    }
    return x;
  }
};

template <class T>
struct VaeDecoder {
  VaeSizes sizes;
  Linear<T> first, second;
  BatchNorm<T> dense_norm;
  std::vector<VaeTransposedConv<T>> widening;
  std::vector<BatchNorm<T>> conv_norms;  ///< behind the widening ones
  std::vector<VaeConv<T>> narrowing;

  explicit VaeDecoder(const VaeSizes& s)
      : sizes(s),
        first{s.latent, s.decoder_width},
        second{s.decoder_width, s.decoder_convs[0].in * s.seed_frames()},
        dense_norm{s.decoder_width} {
    for (std::size_t i = 0; i < 2; ++i) {
      widening.push_back({s.decoder_convs[i]});
      conv_norms.push_back({s.decoder_convs[i].out});
      narrowing.push_back({s.decoder_convs[i + 2]});
    }
  }

  template <class V>
  void visit(V& v) {
    v.scope("fc_layers.0", first);
    v.scope("fc_layers.1", dense_norm);
    v.scope("fc_layers.3", second);
    v.scope("conv_layers.0", widening[0]);
    v.scope("conv_layers.1", conv_norms[0]);
    v.scope("conv_layers.3", widening[1]);
    v.scope("conv_layers.4", conv_norms[1]);
    v.scope("conv_layers.6", narrowing[0]);
    v.scope("conv_layers.7", narrowing[1]);
  }

  /// Codes [.., 1, L] -> windows [.., W, K], in [0, 1).
  template <class Norm = MeasuredStatistics<T>>
  T operator()(const T& code, const Norm& norm = {}) const {
    using B = Operations<T>;
    using C = ChannelOperations<T>;
    T x = second(C::leaky_relu(norm(dense_norm, first(code)), kDenseSlope));
    x = C::from_channel_runs(x, sizes.seed_frames());
    for (std::size_t i = 0; i < widening.size(); ++i)
      x = C::leaky_relu(norm(conv_norms[i], widening[i](x)), kConvSlope);
    return B::tanh(B::relu(narrowing[1](narrowing[0](x))));
  }
};

template <class T>
struct Vae {
  VaeEncoder<T> encoder;
  VaeDecoder<T> decoder;

  explicit Vae(const VaeSizes& s) : encoder(s), decoder(s) {}
  template <class V>
  void visit(V& v) {
    v.scope("encoder", encoder);
    v.scope("decoder", decoder);
  }
  /// The feature of a window: the mean of its code. [.., W, K] -> [.., 1, L]
  T feature(const T& window) const { return encoder.mean(encoder.hidden(encoder.flattened(window))); }
};

/// A codec from a model file, ready to run. Errors: those of reading; Errc::incompatible for a model of
/// another kind and weights that do not fit.
Result<Vae<Tensor>> load_vae(const std::filesystem::path& path);

/// Features of the windows that begin at frames 0, 1 ... `num_windows` - 1 of a sequence: the bits of
/// Vae::feature, but each convolution is computed once for all windows that share it.
/// @param coefficients  [N, K], N >= num_windows + W - 1 unless num_windows is 0
/// @return  [num_windows, L]
Tensor window_features(const Vae<Tensor>& vae, const Tensor& coefficients, std::int64_t num_windows);

}  // namespace mien::said
