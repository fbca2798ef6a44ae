#pragma once
#include <torch/torch.h>

#include <string>
#include <variant>
#include <vector>

#include "mien/models/facediffuser/network.h"
#include "mien/models/facexhubert/network.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/train/torch_operations.h"
#include "mien/train/torch_parameters.h"

namespace mien::train {

/// FaceXHuBERT or a FaceDiffuser with its speech encoder: parameters as in a model file.
struct FaceNetwork {
  using Head =
      std::variant<facexhubert::Network<torch::Tensor>, facediffuser::VertexDenoiser<torch::Tensor>,
                   facediffuser::BeatDenoiser<torch::Tensor>, facediffuser::DammDenoiser<torch::Tensor>>;
  SpeechEncoder<torch::Tensor> encoder;
  Head head;
  double fps = 25;  ///< of the motion

  template <class V>
  void visit(V& v) {
    v.scope("audio_encoder", encoder);
    std::visit([&](auto& h) { h.visit(v); }, head);
  }
  [[nodiscard]] bool is_diffusion() const {
    return std::visit(
        [](const auto& h) {
          if constexpr (requires { h.sizes.is_diffusion(); }) return h.sizes.is_diffusion();
          return false;
        },
        head);
  }
  /// Columns of the style; 0 for the systems without.
  [[nodiscard]] std::int64_t num_styles() const {
    return std::visit([](const auto& h) { return h.sizes.num_subjects; }, head);
  }
  [[nodiscard]] std::int64_t num_channels() const {
    return std::visit([](const auto& h) { return h.sizes.num_channels; }, head);
  }
};

/// Start values of the published programs: the head as PyTorch initialises its layers, except that the last
/// layer of meshes is zero and that of B-DAMM N(0, 1). The encoder's are of no use: load a trained one.
void initialise_as_published(FaceNetwork& network, std::uint64_t seed);

/// What the published programs keep as it was: the convolutions, the projection, the first two layers.
std::vector<std::string> published_frozen();

}  // namespace mien::train
