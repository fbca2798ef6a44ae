#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "mien/base/result.h"
#include "mien/io/safetensors.h"
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

struct Sizes {
  Variant variant = Variant::vertices;
  std::int64_t num_channels = 0;  ///< D
  std::int64_t latent = 0;        ///< L, of the tokens
  std::int64_t hidden = 0;        ///< of the GRU; L for V and DAMM
  std::int64_t num_layers = 2;    ///< of the GRU
  std::int64_t num_steps = 0;     ///< entries of the time table: T, or 5000 for DAMM
  std::int64_t condition = 1536;  ///< H
  std::int64_t num_subjects = 0;  ///< V only
  std::int64_t num_taps = 9;      ///< V only: of the filter along the latent axis
  /// ProbTalk3D's emotional form of V (its paper, section 5.1): the style (identity, emotion and intensity)
  /// scales the tokens of speech, not the states of the GRU, whose width is then free.
  bool styles_speech = false;
};

/// Columns of the published emotional form's style, by which it is told from V: 32 identities, 8 emotions, 3
/// intensities.
inline constexpr std::int64_t kEmotionalStyle = 43;

/// Read from names and shapes of the stored tensors. `styles_speech`: what is known of V's style; else it is
/// told by the width of the style and of the GRU. Errors (Errc::incompatible): weights of no variant.
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
  Linear<T> noise_in{sizes.num_channels, 2 * sizes.latent};
  ChannelFilter<T> noise_filter{sizes.num_taps};
  Linear<T> speech{sizes.condition, sizes.latent};
  Linear<T> time{sizes.num_steps, sizes.latent};
  LayerNorm<T> norm{3 * sizes.latent};
  Gru<T> gru{3 * sizes.latent, sizes.hidden, sizes.num_layers};
  Linear<T> out{sizes.hidden, sizes.num_channels, Init::zero};
  WeightedEmbedding<T> styles{sizes.num_subjects, sizes.latent};

  explicit VertexDenoiser(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    v.scope("input_projection.0", noise_in);
    v.scope("input_projection.1", noise_filter);
    v.scope("cond_projection", speech);
    v.scope("time_mlp.0", time);
    v.scope("norm_cond", norm);
    v.scope("gru", gru);
    v.scope("final_layer", out);
    v.scope("obj_vector", styles);
  }

  /// Aligned features [.., N, H] -> [.., N, L].
  T speech_tokens(const T& aligned) const { return speech(aligned); }
  T time_token(const T& like, std::int64_t step) const { return one_hot_time(time, like, step); }
  /// Weights of subjects [.., 1, S], one-hot as published -> [.., 1, L].
  T style(const T& weights) const { return styles(weights); }
  /// [.., N, D] -> [.., N, L], frame by frame.
  T noise_tokens(const T& x_t) const {
    using B = Operations<T>;
    return B::max_pool_pairs(B::relu(noise_filter(noise_in(x_t))));
  }
  /// Input of the GRU, [.., N, 3 L].
  T tokens(const T& x_t, const Conditions<T>& given, std::int64_t step) const {
    using B = Operations<T>;
    return norm(B::concat_columns({sizes.styles_speech ? B::mul(given.speech, given.style) : given.speech,
                                   noise_tokens(x_t), repeated(time_token(x_t, step), x_t, sizes.latent)}));
  }
  /// `between` acts between the layers of the GRU (dropout in training).
  template <class Between>
  T predict_x0(const T& x_t, const Conditions<T>& given, std::int64_t step, Between&& between) const {
    using B = Operations<T>;
    const T states = gru(tokens(x_t, given, step), between);
    return B::add(out(sizes.styles_speech ? states : B::mul(states, given.style)), given.neutral);
  }
  T predict_x0(const T& x_t, const Conditions<T>& given, std::int64_t step) const {
    return predict_x0(x_t, given, step, [](T y) { return y; });
  }
};

template <class T>
struct BeatDenoiser {
  Sizes sizes;
  Linear<T> time{sizes.num_steps, sizes.latent};
  LayerNorm<T> norm{sizes.condition + sizes.num_channels + sizes.latent};
  Gru<T> gru{norm.width, sizes.hidden, sizes.num_layers};
  Linear<T> out{sizes.hidden, sizes.num_channels};

  explicit BeatDenoiser(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    v.scope("time_mlp.0", time);
    v.scope("norm_cond", norm);
    v.scope("gru", gru);
    v.scope("final_layer", out);
  }

  T speech_tokens(const T& aligned) const { return aligned; }
  T time_token(const T& like, std::int64_t step) const { return one_hot_time(time, like, step); }
  T tokens(const T& x_t, const Conditions<T>& given, std::int64_t step) const {
    using B = Operations<T>;
    return norm(B::concat_columns({given.speech, x_t, repeated(time_token(x_t, step), x_t, sizes.latent)}));
  }
  template <class Between>
  T predict_x0(const T& x_t, const Conditions<T>& given, std::int64_t step, Between&& between) const {
    return out(gru(tokens(x_t, given, step), between));
  }
  T predict_x0(const T& x_t, const Conditions<T>& given, std::int64_t step) const {
    return predict_x0(x_t, given, step, [](T y) { return y; });
  }
};

template <class T>
struct DammDenoiser {
  Sizes sizes;
  T sinusoids{}, sinusoids_again{};  // [entries, 1, L]; one table under two names
  Linear<T> time1{sizes.latent, sizes.latent}, time2{sizes.latent, sizes.latent};
  Gru<T> gru{sizes.condition + sizes.latent + sizes.num_channels, sizes.hidden, sizes.num_layers};
  Linear<T> out{sizes.hidden, sizes.num_channels};

  explicit DammDenoiser(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    const Shape table = {sizes.num_steps, 1, sizes.latent};
    v.buffer("sequence_pos_encoder.pe", sinusoids_again, table);
    v.buffer("embed_timestep.sequence_pos_encoder.pe", sinusoids, table);
    v.scope("embed_timestep.time_embed.0", time1);
    v.scope("embed_timestep.time_embed.2", time2);
    v.scope("rnn", gru);
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
    return B::concat_columns({given.speech, repeated(time_token(x_t, step), x_t, sizes.latent), x_t});
  }
  template <class Between>
  T predict_x0(const T& x_t, const Conditions<T>& given, std::int64_t step, Between&& between) const {
    return out(gru(tokens(x_t, given, step), between));
  }
  T predict_x0(const T& x_t, const Conditions<T>& given, std::int64_t step) const {
    return predict_x0(x_t, given, step, [](T y) { return y; });
  }
};

}  // namespace mien::facediffuser
