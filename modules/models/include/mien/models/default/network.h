#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "mien/models/default/face_space.h"
#include "mien/nn/causal.h"
#include "mien/nn/recurrent.h"

namespace mien::default_model {

// The networks of the default model (docs/default_model.md). Letters: M mel frames at 100 Hz, N motion frames
// at 60 fps, K chunks of 200 ms, W width, C width of the condition, U upper-face numbers.

inline constexpr std::int64_t kMelBands = 64;
inline constexpr std::int64_t kChunkFrames = 12;    // 60 fps frames in a chunk
inline constexpr std::int64_t kChunkSamples = 6;    // 30 fps samples in a chunk
inline constexpr std::int64_t kStyleEntries = 13;   // 12 training styles and "unknown"
inline constexpr std::int64_t kEmotionEntries = 9;  // 8 emotions and "unknown"
inline constexpr std::int64_t kNumLatents = 3;  // take-level strength of jaw, lips and expression, N(0, 1)
inline constexpr std::int64_t kNumVisemes = 28;
inline constexpr std::int64_t kNumTimeFeatures = 32;
inline constexpr std::int64_t kSmootherReach =
    2;  // frames to either side that a frame that comes out waits for

// What the later paths know of the speech: means of the features over groups of four frames. A group ends at
// a frame that four divides; a chunk knows the three that end at or before its first frame.
inline constexpr std::int64_t kContextGroups = 3;
inline constexpr std::int64_t kGroupFrames = kChunkFrames / kContextGroups;

/// Sizes that a model file states.
struct Sizes {
  std::int64_t width = 160;     // W of the speech encoder and mean path
  std::int64_t condition = 64;  // C
  std::int64_t diffusion_hidden = 256;
  std::int64_t blink_hidden = 128;
  std::int64_t brow_hidden = 128;
};

/// Who speaks and in what mood, as weights of table entries: style [.., 1 or N, 13] sums to 1; emotion [.., 1
/// or N, 9] carries the intensity of its entry; latents [.., 1 or N, 3].
template <class T>
struct ConditionInput {
  T style, emotion, latents;
};

/// c = Linear(silu(style + emotion + latents)). Each path has its own.
template <class T>
struct Condition {
  std::int64_t width = 0;
  WeightedEmbedding<T> style{kStyleEntries, width};
  WeightedEmbedding<T> emotion{kEmotionEntries, width};
  Linear<T> latents{kNumLatents, width};
  Linear<T> out{width, width};

  template <class V>
  void visit(V& v) {
    v.scope("style", style);
    v.scope("emotion", emotion);
    v.scope("latents", latents);
    v.scope("out", out);
  }
  T operator()(const ConditionInput<T>& in) const {
    using B = Operations<T>;
    return out(B::silu(B::add(B::add(style(in.style), emotion(in.emotion)), latents(in.latents))));
  }
};

/// Log-mel features -> speech features. Causal: it sees ahead only because its input is shifted in time.
template <class T>
struct SpeechEncoder {
  std::int64_t width = 0;
  CausalConv<T> conv1{kMelBands, width, 5, 1};
  CausalConv<T> conv2{width, width, 5, 1};
  std::vector<CausalBlock<T>> blocks;
  LayerNorm<T> norm{width};
  Linear<T> visemes{width, kNumVisemes};  // trained beside the curves: keeps phone identity in the features
  Linear<T> events{width, 2};             // logits: lips closed, accent

  explicit SpeechEncoder(std::int64_t w) : width(w) {
    for (const std::int64_t dilation : {1, 2, 4, 8, 1, 2}) blocks.push_back({w, dilation});
  }
  template <class V>
  void visit(V& v) {
    v.scope("conv1", conv1);
    v.scope("conv2", conv2);
    v.scope("blocks", blocks);
    v.scope("norm", norm);
    v.scope("visemes", visemes);
    v.scope("events", events);
  }

  /// mel [.., M, 64] -> [.., M, W], at 100 Hz.
  T encode_mel(const T& mel, CausalState<T>* state) const {
    using B = Operations<T>;
    return B::gelu(conv2(B::gelu(conv1(mel, state)), state));
  }
  /// The above interpolated to 60 fps, [.., N, W] -> features [.., N, W].
  T encode_frames(T x, CausalState<T>* state) const {
    for (const auto& block : blocks) x = block(x, state);
    return norm(x);
  }
};

/// Features and condition -> mean of the standardised face, [.., N, 45]. It alone decides the lips.
template <class T>
struct MeanPath {
  std::int64_t width = 0, condition_width = 0;
  Condition<T> condition{condition_width};
  std::vector<CausalBlock<T>> blocks;
  std::vector<Linear<T>> modulations;
  Linear<T> out{width, kNumFace};

  MeanPath(std::int64_t w, std::int64_t c) : width(w), condition_width(c) {
    for (const std::int64_t dilation : {1, 2}) {
      blocks.push_back({w, dilation});
      modulations.push_back({c, 2 * w, Init::zero});
    }
  }
  template <class V>
  void visit(V& v) {
    v.scope("condition", condition);
    v.scope("blocks", blocks);
    v.scope("modulations", modulations);
    v.scope("out", out);
  }
  /// features [.., N, W], c [.., 1 or N, C] = condition(...).
  T operator()(T x, const T& c, CausalState<T>* state) const {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const T modulation = modulations[i](c);
      x = blocks[i](x, state, &modulation);
    }
    return out(x);
  }
};

/// Chunk diffusion of the upper face, gaze and head, predicting x0 (docs/default_model.md, section 4). One
/// recurrent step a chunk reads the clean past; the small head runs once a diffusion step.
template <class T>
struct DiffusionPath {
  std::int64_t width = 0, condition_width = 0, hidden = 0;
  static constexpr std::int64_t kChunkNumbers = kChunkSamples * kNumUpper;
  static constexpr std::int64_t kHistory = 192, kAudio = 128, kNumBlocks = 3;

  Condition<T> condition{condition_width};
  Linear<T> history{kChunkNumbers, kHistory};
  Linear<T> audio{kContextGroups * width, kAudio};
  GruLayer<T> gru1{kAudio + kHistory + condition_width, hidden};
  GruLayer<T> gru2{hidden, hidden};
  Linear<T> context{hidden + kAudio + kHistory, hidden};
  Linear<T> time1{kNumTimeFeatures, hidden}, time2{hidden, hidden};
  Linear<T> in{kChunkNumbers, hidden};
  LayerNorm<T> norm1{hidden}, norm2{hidden}, norm3{hidden}, out_norm{hidden};
  Linear<T> modulation{hidden, 3 * kNumBlocks* hidden};
  std::vector<Linear<T>> expand, contract;
  Linear<T> out{hidden, kChunkNumbers, Init::zero};

  DiffusionPath(std::int64_t w, std::int64_t c, std::int64_t h) : width(w), condition_width(c), hidden(h) {
    for (int i = 0; i < kNumBlocks; ++i) {
      expand.push_back({h, h});
      contract.push_back({h, h});
    }
  }
  template <class V>
  void visit(V& v) {
    v.scope("condition", condition);
    v.scope("history", history);
    v.scope("audio", audio);
    v.scope("gru1", gru1);
    v.scope("gru2", gru2);
    v.scope("context", context);
    v.scope("time1", time1);
    v.scope("time2", time2);
    v.scope("in", in);
    v.scope("norm1", norm1);
    v.scope("norm2", norm2);
    v.scope("norm3", norm3);
    v.scope("out_norm", out_norm);
    v.scope("modulation", modulation);
    v.scope("expand", expand);
    v.scope("contract", contract);
    v.scope("out", out);
  }

  struct State {
    T first, second;  // [.., 1, hidden]
  };

  /// Reads K chunks. past [.., K, 6 U]: the clean samples of the chunk before each, standardised; speech [..,
  /// K, 3 W]; c [.., 1 or K, C] -> h [.., K, hidden].
  T read(const T& past, const T& speech, const T& c, State& state) const {
    using B = Operations<T>;
    const T p = B::silu(history(past));
    const T q = audio(speech);
    const T everywhere = B::add(B::zero_rows(q, B::num_rows(q), condition_width), c);
    const T g = gru2(gru1(B::concat_columns({q, p, everywhere}), state.first), state.second);
    return context(B::concat_columns({g, q, p}));
  }

  /// Estimate of the chunk's clean coefficients. x_t [.., K, 6 U], time [.., 1 or K, 32] =
  /// time_features(level).
  T predict_x0(const T& h, const T& x_t, const T& time) const {
    using B = Operations<T>;
    const T step = time2(B::silu(time1(time)));
    const T m = modulation(B::silu(B::add(h, step)));
    T y = B::add(in(x_t), h);
    const std::array norms = {&norm1, &norm2, &norm3};
    for (std::int64_t i = 0; i < kNumBlocks; ++i) {
      const auto part = [&](std::int64_t k) { return B::columns(m, (3 * i + k) * hidden, hidden); };
      const T normed = B::add(B::mul((*norms[i])(y), B::add_one(part(0))), part(1));
      const T change = contract[i](B::silu(expand[i](normed)));
      y = B::add(y, B::mul(change, B::add_one(part(2))));
    }
    return out(out_norm(y));
  }
};

/// Sines and cosines of half the log signal-to-noise ratio at 16 frequencies: a level instead of a step
/// number, so that any subset of steps is legal.
std::array<float, kNumTimeFeatures> time_features(double half_log_snr);

/// Events that an event path decides step after step: at most one begins in a step. Step k decides about
/// frames `frames` k + `offset` and the `frames` - 1 after it when it has heard the features up to frame
/// `frames` k.
struct EventKind {
  std::int64_t frames;  // of a step
  std::int64_t offset;  // 0 or negative: how far the first decided frame lies before the last one heard
  std::int64_t groups;  // of speech context that a step reads
  bool has_size;        // one more output: the expected logarithm of the event's size

  /// Class 0 is "none", 1 + f is onset in frame f of the step.
  [[nodiscard]] constexpr std::int64_t num_classes() const { return frames + 1; }
  [[nodiscard]] constexpr std::int64_t num_outputs() const { return num_classes() + (has_size ? 1 : 0); }
  /// One-hot class of the previous step, and the time since the last onset.
  [[nodiscard]] constexpr std::int64_t num_history() const { return num_classes() + 1; }
};
inline constexpr EventKind kBlinks{kChunkFrames, 0, kContextGroups, false};
/// A raise answers an accent that must have been heard, so brows decide late: every four frames, and about
/// frames that the smoother holds back anyway.
inline constexpr EventKind kBrowRaises{kGroupFrames, -kSmootherReach, 1, true};
inline constexpr double kTypicalRaise = 0.2;    // the size output is ln(amplitude / this)
inline constexpr double kRaiseLogSpread = 0.3;  // sd of ln(amplitude) around it: that of one speaker's raises

/// When events begin: a distribution over the frames of a step, or none. Trained by likelihood, so their rate
/// is calibrated.
template <class T>
struct EventPath {
  EventKind kind;
  std::int64_t width = 0, condition_width = 0, hidden = 0;
  static constexpr std::int64_t kAudio = 64;
  Condition<T> condition{condition_width};
  Linear<T> audio{kind.groups * width, kAudio};
  GruLayer<T> gru{kAudio + kind.num_history() + condition_width, hidden};
  Linear<T> out{hidden, kind.num_outputs()};

  EventPath(const EventKind& k, std::int64_t w, std::int64_t c, std::int64_t h)
      : kind(k), width(w), condition_width(c), hidden(h) {}
  template <class V>
  void visit(V& v) {
    v.scope("condition", condition);
    v.scope("audio", audio);
    v.scope("gru", gru);
    v.scope("out", out);
  }

  /// speech [.., K, groups W]; history [.., K, num_history] = EventHistory; c [.., 1 or K, C]; state [.., 1,
  /// hidden] -> [.., K, num_outputs]: logits of the classes, then the size where the kind has one.
  T operator()(const T& speech, const T& history, const T& c, T& state) const {
    using B = Operations<T>;
    const T q = B::silu(audio(speech));
    const T everywhere = B::add(B::zero_rows(q, B::num_rows(q), condition_width), c);
    return out(gru(B::concat_columns({q, history, everywhere}), state));
  }
};

/// Statistics of the training set that the networks' inputs and outputs are measured in.
template <class T>
struct Statistics {
  T face_mean, face_sd;  // [45]
  T coefficient_sd;      // [6 U] of the chunk coefficients, in standardised units

  template <class V>
  void visit(V& v) {
    v.buffer("face_mean", face_mean, Shape{kNumFace});
    v.buffer("face_sd", face_sd, Shape{kNumFace});
    v.buffer("coefficient_sd", coefficient_sd, Shape{kChunkSamples * kNumUpper});
  }
};

template <class T>
struct Network {
  Sizes sizes;
  SpeechEncoder<T> encoder{sizes.width};
  MeanPath<T> mean{sizes.width, sizes.condition};
  DiffusionPath<T> diffusion{sizes.width, sizes.condition, sizes.diffusion_hidden};
  EventPath<T> blink{kBlinks, sizes.width, sizes.condition, sizes.blink_hidden};
  EventPath<T> brow{kBrowRaises, sizes.width, sizes.condition, sizes.brow_hidden};
  Statistics<T> statistics;

  explicit Network(const Sizes& s) : sizes(s) {}
  template <class V>
  void visit(V& v) {
    v.scope("encoder", encoder);
    v.scope("mean", mean);
    v.scope("diffusion", diffusion);
    v.scope("blink", blink);
    v.scope("brow", brow);
    v.scope("statistics", statistics);
  }
};

}  // namespace mien::default_model
