#pragma once
#include <string>
#include <variant>

#include "backend.h"
#include "mien/models/alignment.h"
#include "mien/models/facediffuser/network.h"
#include "mien/models/facexhubert/network.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/motion/frame_noise.h"

namespace mien::parity {

template <class T>
T taken(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message());
  return std::move(result).value();
}

/// "case.", 3 -> "case.3". (A literal plus a text gives false alarms in GCC 12.)
inline std::string numbered(std::string name, std::int64_t index) {
  return name.append(std::to_string(index));
}

template <class T>
using AnyDenoiser = std::variant<facediffuser::VertexDenoiser<T>, facediffuser::BeatDenoiser<T>,
                                 facediffuser::DammDenoiser<T>>;

/// The network of a file; the speech encoder's weights are left to encoder_of().
template <class T>
AnyDenoiser<T> denoiser_of(const Fixture& weights) {
  using namespace facediffuser;
  const Sizes sizes = taken(sizes_of(weights.file()));
  if (sizes.variant == Variant::vertices) return Backend<T>::load(weights, VertexDenoiser<T>(sizes));
  if (sizes.variant == Variant::beat) return Backend<T>::load(weights, BeatDenoiser<T>(sizes));
  return Backend<T>::load(weights, DammDenoiser<T>(sizes));
}

template <class T>
facexhubert::Network<T> facexhubert_of(const Fixture& weights) {
  return Backend<T>::load(weights, facexhubert::Network<T>(taken(facexhubert::sizes_of(weights.file()))));
}

/// The shrunken encoder of a case: what its configuration says under "hubert".
EncoderConfig recorded_encoder(const nlohmann::json& hubert);
template <class T>
SpeechEncoder<T> encoder_of(const Fixture& weights) {
  return Backend<T>::load(weights, SpeechEncoder<T>(recorded_encoder(weights.config().at("hubert"))),
                          "audio_encoder.");
}

/// What the speech encoder gave: its last layer [A, H].
Tensor speech_features(const Fixture& recorded);
/// All values as one row.
Tensor as_row(const Tensor& x);
/// The raw recording of a case, normalised by us; it must be the recorded normalised one. [S, 1]
Tensor waveform(const Fixture& inputs, const std::string& suffix = "");

template <class T>
T aligned_features(const T& features, std::int64_t num_frames, double fps) {
  return aligned(features, align_features(Operations<T>::num_rows(features), num_frames, fps));
}

/// A recorded case of FaceDiffuser: its network, and the conditions of its inputs.
template <class T>
struct DiffuserCase {
  explicit DiffuserCase(const std::string& case_name)
      : name(case_name),
        network(denoiser_of<T>(open("weights"))),
        forward(open("forward")),
        fps(forward.config().at("fps").template get<double>()),
        num_steps(forward.config().at("steps").template get<std::int64_t>()) {
    const Tensor x_t = forward.tensor("x_t");
    num_channels = x_t.width();
    hear(aligned_features(Backend<T>::given(speech_features(forward)), x_t.num_rows(), fps));
    if (const auto* v = vertices()) {
      const Fixture inputs = open("inputs");
      given.style = v->style(Backend<T>::given(as_row(inputs.tensor("one_hot"))));
      given.neutral = Backend<T>::given(as_row(inputs.tensor("template")));
    }
  }
  std::string name;
  AnyDenoiser<T> network;
  Fixture forward;
  double fps;
  std::int64_t num_steps;  ///< T, from the configuration
  std::int64_t num_channels = 0;
  T aligned_speech;  ///< [N, f H]
  facediffuser::Conditions<T> given;

  [[nodiscard]] Fixture open(const std::string& stage) const {
    return Fixture("facediffuser", name + "." + stage + ".safetensors");
  }
  /// Sets the condition: aligned features [N, f H].
  void hear(T speech) {
    aligned_speech = std::move(speech);
    std::visit([&](const auto& n) { given.speech = n.speech_tokens(aligned_speech); }, network);
  }
  [[nodiscard]] const facediffuser::VertexDenoiser<T>* vertices() const {
    return std::get_if<facediffuser::VertexDenoiser<T>>(&network);
  }
  [[nodiscard]] std::int64_t num_frames() const { return Operations<T>::num_rows(given.speech); }
  [[nodiscard]] Tensor predict_x0(const Tensor& x_t, std::int64_t step) const {
    return Backend<T>::values(std::visit(
        [&](const auto& n) { return n.predict_x0(Backend<T>::given(x_t), given, step); }, network));
  }
};

/// Recorded noise: initial [1, N, D], per step [K, N, D] (absent in deterministic walks).
class RecordedNoise final : public FrameNoise {
 public:
  RecordedNoise(const Fixture& fixture, const std::string& initial, const std::string& steps);
  void start(std::int64_t frame, std::span<float> out) const override;
  void step(int step, std::int64_t frame, std::span<float> out) const override;

 private:
  Tensor initial_;
  std::vector<Tensor> steps_;
};

}  // namespace mien::parity
