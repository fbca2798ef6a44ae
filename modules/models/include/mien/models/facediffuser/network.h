#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "mien/base/result.h"
#include "mien/io/safetensors.h"
#include "mien/models/face_decoder.h"
#include "mien/nn/layers.h"

// The denoisers of FaceDiffuser behind the speech encoder: estimates of the clean animation x0 [N, D] from
// speech aligned with the frames, the noisy animation x_t and the number of the diffusion step. Letters: N
// frames, D channels, L latent width, H speech features side by side (1536 as published).
namespace mien::facediffuser {

enum class Variant {
  vertices,  ///< V: meshes, with a noise encoder, styles and a neutral face
  beat,      ///< B-BEAT: ARKit coefficients
  damm,      ///< B-DAMM: rig controls
};

/// What makes a token of the noisy mesh (V only; thesis, section 8.3). All begin with a map D -> 2 L.
enum class NoiseEncoder {
  conv_max,      ///< a filter along the 2 L numbers, the larger of each pair: as published
  conv_average,  ///< the mean of each pair
  mlp,           ///< a second map, 2 L -> L
};
std::optional<NoiseEncoder> parse_noise_encoder(std::string_view name);  ///< "conv_max" ...
std::string_view noise_encoder_name(NoiseEncoder kind);

struct Sizes {
  Variant variant = Variant::vertices;
  std::int64_t num_channels = 0;  ///< D
  std::int64_t latent = 0;        ///< L, of the tokens
  std::int64_t hidden = 0;        ///< of the decoder; L for V and DAMM
  DecoderSizes decoder = {};
  /// Entries of the time table: T, or 5000 for DAMM. 0: the ablation without diffusion, which reads nothing
  /// but speech (thesis, section 8.4).
  std::int64_t num_steps = 0;
  std::int64_t condition = 1536;  ///< H
  std::int64_t num_subjects = 0;  ///< V only
  std::int64_t num_taps = 9;      ///< V only: of the filter along the latent axis
  NoiseEncoder noise_encoder = NoiseEncoder::conv_max;
  /// ProbTalk3D's emotional form of V (its paper, section 5.1): the style (identity, emotion and intensity)
  /// scales the tokens of speech, not the states of the decoder, whose width is then free.
  bool styles_speech = false;

  [[nodiscard]] bool is_diffusion() const { return num_steps > 0; }
};

/// Columns of the published emotional form's style, by which it is told from V: 32 identities, 8 emotions, 3
/// intensities.
inline constexpr std::int64_t kEmotionalStyle = 43;

/// Read from names and shapes of the stored tensors. They do not tell the mean of pairs from their larger
/// number, nor the heads of a transformer: those stay as by default. `styles_speech`: what is known of V's
/// style; else it is told by the width of the style and of the decoder. Errors (Errc::incompatible): weights
/// of no variant.
Result<Sizes> sizes_of(const std::map<std::string, Shape>& shapes, std::optional<bool> styles_speech = {});
Result<Sizes> sizes_of(const SafetensorsFile& file, std::optional<bool> styles_speech = {});

/// Everything about a performance that no diffusion step changes.
template <class T>
struct Conditions {
  T speech;   ///< [.., N, token]: what speech_tokens() gave
  T style;    ///< [.., 1, L]: what style() gave; V only
  T neutral;  ///< [.., 1, D]; V only
};

/// A convolution along the channel axis with one filter for all places.
template <class T>
struct ChannelFilter {
  std::int64_t num_taps = 0;
  T taps{}, bias{};
  template <class V>
  void visit(V& v) {
    v.tensor("weight", taps, Shape{1, 1, num_taps}, Init::fan_in);
    v.tensor("bias", bias, Shape{1}, Init::fan_in);
  }
  T operator()(const T& x) const { return Operations<T>::convolve_columns(x, taps, bias); }
};

/// Noisy meshes as tokens, frame by frame: [.., N, D] -> [.., N, L].
template <class T>
struct VertexNoiseEncoder {
  NoiseEncoder kind = NoiseEncoder::conv_max;
  std::int64_t num_channels = 0, latent = 0, num_taps = 9;
  Linear<T> map{num_channels, 2 * latent};
  ChannelFilter<T> filter{num_taps};     // of the convolutions
  Linear<T> second{2 * latent, latent};  // of the MLP

  template <class V>
  void visit(V& v) {
    v.scope("0", map);
    if (kind == NoiseEncoder::mlp)
      v.scope("1", second);
    else
      v.scope("1", filter);
  }
  T operator()(const T& x_t) const {
    using B = Operations<T>;
    if (kind == NoiseEncoder::mlp) return B::relu(second(B::relu(map(x_t))));
    const T filtered = B::relu(filter(map(x_t)));
    return kind == NoiseEncoder::conv_max ? B::max_pool_pairs(filtered) : B::mean_pool_pairs(filtered);
  }
};

/// Token of a step from one-hot numbers: mish of a column of the weights.
template <class T>
T one_hot_time(const Linear<T>& time, const T& like, std::int64_t step) {
  using B = Operations<T>;
  return B::mish(time(B::one_hot(like, step, time.in)));
}

/// One row for every row of x.
template <class T>
T repeated(const T& row, const T& x, std::int64_t width) {
  using B = Operations<T>;
  return B::add(B::zero_rows(x, B::num_rows(x), width), row);
}

template <class T>
struct VertexDenoiser {
  Sizes sizes;
  VertexNoiseEncoder<T> noise{sizes.noise_encoder, sizes.num_channels, sizes.latent, sizes.num_taps};
  Linear<T> speech{sizes.condition, sizes.latent};
  Linear<T> time{sizes.num_steps, sizes.latent};
  LayerNorm<T> norm{(sizes.is_diffusion() ? 3 : 1) * sizes.latent};
  FaceDecoder<T> decoder{sizes.decoder, norm.width, sizes.hidden, sizes.num_channels};
  Linear<T> out{sizes.hidden, sizes.num_channels, Init::zero};
  WeightedEmbedding<T> styles{sizes.num_subjects, sizes.latent};

  explicit VertexDenoiser(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    if (sizes.is_diffusion()) v.scope("input_projection", noise);
    v.scope("cond_projection", speech);
    if (sizes.is_diffusion()) v.scope("time_mlp.0", time);
    v.scope("norm_cond", norm);
    decoder.visit_as("gru", v);
    v.scope("final_layer", out);
    v.scope("obj_vector", styles);
  }

  /// Aligned features [.., N, H] -> [.., N, L].
  T speech_tokens(const T& aligned) const { return speech(aligned); }
  T time_token(const T& like, std::int64_t step) const { return one_hot_time(time, like, step); }
  /// Weights of the style's columns [.., 1, S], one-hot as published -> [.., 1, L].
  T style(const T& weights) const { return styles(weights); }
  /// Input of the decoder, [.., N, 3 L]; without diffusion [.., N, L], of speech alone.
  T tokens(const T& x_t, const Conditions<T>& given, std::int64_t step) const {
    using B = Operations<T>;
    const T heard = sizes.styles_speech ? B::mul(given.speech, given.style) : given.speech;
    if (!sizes.is_diffusion()) return norm(heard);
    return norm(B::concat_columns({heard, noise(x_t), repeated(time_token(x_t, step), x_t, sizes.latent)}));
  }
  /// Without diffusion x_t and step are not read.
  T predict_x0(const T& x_t, const Conditions<T>& given, std::int64_t step,
               const DecoderPass<T>& pass = {}) const {
    using B = Operations<T>;
    const auto offsets = [&](const T& h) { return out(sizes.styles_speech ? h : B::mul(h, given.style)); };
    return B::add(decoder(tokens(x_t, given, step), offsets, pass), given.neutral);
  }
};

template <class T>
struct BeatDenoiser {
  Sizes sizes;
  Linear<T> time{sizes.num_steps, sizes.latent};
  LayerNorm<T> norm{sizes.condition + (sizes.is_diffusion() ? sizes.num_channels + sizes.latent : 0)};
  FaceDecoder<T> decoder{sizes.decoder, norm.width, sizes.hidden, sizes.num_channels};
  Linear<T> out{sizes.hidden, sizes.num_channels};

  explicit BeatDenoiser(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    if (sizes.is_diffusion()) v.scope("time_mlp.0", time);
    v.scope("norm_cond", norm);
    decoder.visit_as("gru", v);
    v.scope("final_layer", out);
  }

  T speech_tokens(const T& aligned) const { return aligned; }
  T time_token(const T& like, std::int64_t step) const { return one_hot_time(time, like, step); }
  T tokens(const T& x_t, const Conditions<T>& given, std::int64_t step) const {
    using B = Operations<T>;
    if (!sizes.is_diffusion()) return norm(given.speech);
    return norm(B::concat_columns({given.speech, x_t, repeated(time_token(x_t, step), x_t, sizes.latent)}));
  }
  T predict_x0(const T& x_t, const Conditions<T>& given, std::int64_t step,
               const DecoderPass<T>& pass = {}) const {
    return decoder(tokens(x_t, given, step), out, pass);
  }
};

template <class T>
struct DammDenoiser {
  Sizes sizes;
  T sinusoids{}, sinusoids_again{};  // [entries, 1, L]; one table under two names
  Linear<T> time1{sizes.latent, sizes.latent}, time2{sizes.latent, sizes.latent};
  FaceDecoder<T> decoder{sizes.decoder,
                         sizes.condition + (sizes.is_diffusion() ? sizes.latent + sizes.num_channels : 0),
                         sizes.hidden, sizes.num_channels};
  Linear<T> out{sizes.hidden, sizes.num_channels};

  explicit DammDenoiser(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    if (sizes.is_diffusion()) {
      const Shape table = {sizes.num_steps, 1, sizes.latent};
      v.buffer("sequence_pos_encoder.pe", sinusoids_again, table);
      v.buffer("embed_timestep.sequence_pos_encoder.pe", sinusoids, table);
      v.scope("embed_timestep.time_embed.0", time1);
      v.scope("embed_timestep.time_embed.2", time2);
    }
    decoder.visit_as("rnn", v);
    v.scope("out", out);
  }

  T speech_tokens(const T& aligned) const { return aligned; }
  T time_token(const T&, std::int64_t step) const {
    using B = Operations<T>;
    return time2(B::silu(time1(B::table_row(sinusoids, step))));
  }
  /// Not normalised, and in another order than B-BEAT's.
  T tokens(const T& x_t, const Conditions<T>& given, std::int64_t step) const {
    using B = Operations<T>;
    if (!sizes.is_diffusion()) return given.speech;
    return B::concat_columns({given.speech, repeated(time_token(x_t, step), x_t, sizes.latent), x_t});
  }
  T predict_x0(const T& x_t, const Conditions<T>& given, std::int64_t step,
               const DecoderPass<T>& pass = {}) const {
    return decoder(tokens(x_t, given, step), out, pass);
  }
};

}  // namespace mien::facediffuser
