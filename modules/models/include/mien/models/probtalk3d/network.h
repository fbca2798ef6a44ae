#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/io/safetensors.h"
#include "mien/models/probtalk3d/blocks.h"

// ProbTalk3D (Wu et al. 2024, section 4) and its variant with a Gaussian latent. Stage 1 is the motion prior:
// FLAME parameters to a latent and back. Stage 2 predicts that latent from speech and a style. Letters: N
// frames, C channels (50 expression and 3 jaw), D latent width, K codes of width W, H speech features of a
// frame.
namespace mien::probtalk3d {

struct Sizes {
  std::int64_t channels = 53;
  std::int64_t width = 256;  ///< D
  std::int64_t inner = 384;  ///< of the feed-forward parts
  /// Of the attention; no tensor tells how many there are.
  std::int64_t heads = 8;
  std::int64_t prior_blocks = 6;
  std::int64_t num_codes = 256;       ///< K; 0 in the variant with a Gaussian latent
  std::int64_t code_width = 128;      ///< W; 0 in the variant
  std::int64_t predictor_blocks = 0;  ///< 0: stage 1 alone
  std::int64_t condition = 0;         ///< two speech features side by side, 2 H
  std::int64_t style = 0;             ///< identities, emotions and intensities together

  [[nodiscard]] bool is_variational() const { return num_codes == 0; }
  [[nodiscard]] StackSizes prior_stack() const { return {width, inner, heads, prior_blocks}; }
  [[nodiscard]] StackSizes predictor_stack() const { return {width, inner, heads, predictor_blocks}; }
};

/// Names of stage 1 in a stage-2 checkpoint, and of the predictor.
inline constexpr std::string_view kPriorPrefix = "motion_prior.", kPredictorPrefix = "feature_predictor.";

/// Read from the shapes of the stored tensors of stage 2, or of stage 1 alone. `heads` is what the source of
/// the weights says. Errors (Errc::incompatible): not such weights, heads that do not divide the width.
Result<Sizes> sizes_of(const std::map<std::string, Shape>& shapes, std::int64_t heads);

/// FLAME parameters in the normalised range to the latent z.
template <class T>
struct MotionEncoder {
  Sizes sizes;
  Linear<T> feature_mapping{sizes.channels, sizes.width};
  MotionStack<T> stack{sizes.prior_stack(), "squasher", "encoder"};

  explicit MotionEncoder(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    v.scope("feature_mapping.0", feature_mapping);
    stack.visit(v);
  }
  /// motion [.., N, C] -> [.., N, D]
  template <class Hooks = EvaluationHooks<T>>
  T operator()(const T& motion, const Hooks& hooks = {}) const {
    const T h = ChannelOperations<T>::leaky_relu(feature_mapping(motion), kLeakySlope);
    hooks.stage("feature_mapping", h);
    return stack(h, hooks);
  }
};

/// A latent to FLAME parameters in the normalised range.
template <class T>
struct MotionDecoder {
  Sizes sizes;
  MotionStack<T> stack{sizes.prior_stack(), "expander", "decoder"};
  typename Operations<T>::Matrix feature_mapping_reverse{};
  T none{};  // a fixed zero bias, not a parameter

  explicit MotionDecoder(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    stack.visit(v);
    v.matrix("feature_mapping_reverse.weight", feature_mapping_reverse, sizes.channels, sizes.width,
             Init::fan_in);
  }
  /// latent [.., N, D] -> [.., N, C]
  template <class Hooks = EvaluationHooks<T>>
  T operator()(const T& latent, const Hooks& hooks = {}) const {
    return Operations<T>::linear(stack(latent, hooks), feature_mapping_reverse, none);
  }
};

/// The codebook. A code is not a frame nor a part of one: the latent is transposed to [D, N] and cut into
/// runs of W numbers, with time running fastest. So a clip has N D / W codes, most of which hold W successive
/// frames of one channel, and what a code means depends on the length of the clip. (The paper says that codes
/// are aligned with frames; the weights were trained like this.)
template <class T>
struct Quantiser {
  std::int64_t num_codes = 0, code_width = 0, width = 0;
  T codebook{};

  template <class V>
  void visit(V& v) {
    v.tensor("embedding.weight", codebook, Shape{num_codes, code_width}, Init::fan_in);
  }
  /// Whether the latent of a clip can be cut into codes: always when W divides D.
  [[nodiscard]] bool fits(std::int64_t num_frames) const { return num_frames * width % code_width == 0; }
  /// z [.., N, D] -> [.., N D / W, W]. @pre fits(N)
  T chunks(const T& z) const { return ChannelOperations<T>::channel_runs(z, code_width); }
  /// Squared distances of every chunk to every code, [.., N D / W, K].
  T distances(const T& z) const { return ChannelOperations<T>::squared_distances(chunks(z), codebook); }
  /// The codes under these numbers as a latent, [.., N, D].
  T latent(std::span<const std::int64_t> codes, std::int64_t num_frames) const {
    return ChannelOperations<T>::from_channel_runs(Operations<T>::table_rows(codebook, codes), num_frames);
  }
  /// z + (latent - z): its gradient is that of z, as if nothing had been quantised.
  T quantised(const T& z, std::span<const std::int64_t> codes) const {
    return ChannelOperations<T>::straight_through(z, latent(codes, Operations<T>::num_rows(z)));
  }
};

/// Stage 1. One of `quantiser` and (`mean`, `logvar`) is in use.
template <class T>
struct MotionPrior {
  Sizes sizes;
  MotionEncoder<T> encoder{sizes};
  MotionDecoder<T> decoder{sizes};
  Quantiser<T> quantiser{sizes.num_codes, sizes.code_width, sizes.width};
  Linear<T> mean{sizes.width, sizes.width}, logvar{sizes.width, sizes.width};

  explicit MotionPrior(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    v.scope("motion_encoder", encoder);
    v.scope("motion_decoder", decoder);
    if (sizes.is_variational()) {
      v.scope("mean", mean);
      v.scope("logvar", logvar);
    } else {
      v.scope("quantize", quantiser);
    }
  }
};

/// A draw from N(mean, exp(logvar)) with noise [.., N, D] from outside.
template <class T>
T gaussian_sample(const T& mean, const T& logvar, const T& noise) {
  using B = Operations<T>;
  return B::add(mean, B::mul(B::exp(B::scale(logvar, 0.5f)), noise));
}
/// The same with its distance from the mean times `factor`, and with the rounding of the original, which
/// forms the noise as sample - mean.
template <class T>
T gaussian_sample(const T& mean, const T& logvar, const T& noise, float factor) {
  using B = Operations<T>;
  return B::add(mean, B::scale(B::sub(gaussian_sample(mean, logvar, noise), mean), factor));
}

/// Stage 2: speech and style to the latent of the prior.
template <class T>
struct Predictor {
  Sizes sizes;
  Linear<T> audio_feature_map{sizes.condition, sizes.width};
  WeightedEmbedding<T> style_embedding{sizes.style, sizes.width};
  MotionStack<T> stack{sizes.predictor_stack(), "squasher", "encoder"};

  explicit Predictor(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    v.scope("audio_feature_map", audio_feature_map);
    v.scope("style_embedding", style_embedding);
    stack.visit(v);
  }
  /// pairs of speech features [.., N, 2 H], style weights [.., 1, S] -> z [.., N, D]
  template <class Hooks = EvaluationHooks<T>>
  T operator()(const T& pairs, const T& style, const Hooks& hooks = {}) const {
    using B = Operations<T>;
    const T heard = audio_feature_map(pairs);
    hooks.stage("audio_feature_map", heard);
    const T fused = B::mul(heard, style_embedding(style));
    hooks.stage("fused", fused);
    return stack(fused, hooks);
  }
};

/// Both stages behind the speech encoder.
template <class T>
struct Network {
  Sizes sizes;
  MotionPrior<T> prior{sizes};
  Predictor<T> predictor{sizes};

  explicit Network(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    v.scope("motion_prior", prior);
    v.scope("feature_predictor", predictor);
  }
};

}  // namespace mien::probtalk3d
