#pragma once
#include <string>
#include <string_view>

#include "face_weights.h"
#include "mien/motion/diffusion_process.h"
#include "recorded_weights.h"

namespace mien::parity {

/// A recorded case of ProbTalk3D's emotional form of FaceDiffuser: its network with its conditions.
template <class T>
struct EmotionalCase {
  static constexpr std::string_view kSampling = "_sampling.safetensors";
  static constexpr double kFps = 25;

  explicit EmotionalCase(const std::string& name)
      : forward("probtalk3d", name + ".safetensors"),
        sampling("probtalk3d", name + std::string(kSampling)),
        network(recorded_network<T>(
            forward, facediffuser::VertexDenoiser<T>(taken(facediffuser::sizes_of(forward.file()))))),
        process(betas_of(BetaSchedule::cosine, network.sizes.num_steps)) {
    const std::int64_t num_frames = std::stoll(forward.metadata("num_frames"));
    aligned_speech =
        aligned_features(Backend<T>::given(forward.tensor("mid.audio_last_hidden")), num_frames, kFps);
    given.neutral = Backend<T>::given(as_row(forward.tensor("in.template")));
    condition();
  }
  /// What the network makes of speech and style.
  void condition() {
    given.speech = network.speech_tokens(aligned_speech);
    given.style = network.style(Backend<T>::given(as_row(forward.tensor("in.style_onehot"))));
  }
  Fixture forward, sampling;
  facediffuser::VertexDenoiser<T> network;
  DiffusionProcess process;
  T aligned_speech;
  facediffuser::Conditions<T> given;

  [[nodiscard]] Tensor predict_x0(const Tensor& x_t, std::int64_t step) const {
    return Backend<T>::values(network.predict_x0(Backend<T>::given(x_t), given, step));
  }
};

}  // namespace mien::parity
