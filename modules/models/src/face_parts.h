#pragma once
#include <utility>
#include <variant>

#include "mien/models/face_model.h"
#include "mien/models/facediffuser/folded_denoiser.h"
#include "mien/models/facexhubert/network.h"
#include "mien/models/probtalk3d/network.h"
#include "mien/models/speech_encoder/encoder_runtime.h"

namespace mien {

struct FaceModel::Parts {
  ModelFile description;
  EncoderRuntime encoder;
  std::vector<std::pair<std::string, Tensor>> neutrals{};  ///< [1, D], in the order of the file

  /// The network, by architecture.
  std::shared_ptr<const facexhubert::Network<Tensor>> facexhubert{};
  std::shared_ptr<const facediffuser::VertexDenoiser<Tensor>> vertices{};
  std::shared_ptr<const facediffuser::BeatDenoiser<Tensor>> beat{};
  std::shared_ptr<const facediffuser::DammDenoiser<Tensor>> damm{};
  /// FaceDiffuser for sampling frame by frame; none where its decoder is no GRU, or V's noise encoder
  /// another, or it has no diffusion.
  std::shared_ptr<const facediffuser::FoldedDenoiser> folded{};
  std::shared_ptr<const probtalk3d::Network<Tensor>> probtalk3d{};

  [[nodiscard]] facediffuser::Sizes diffuser_sizes() const {
    return vertices != nullptr ? vertices->sizes : beat != nullptr ? beat->sizes : damm->sizes;
  }

  /// The neutral face of a subject; nullptr when the file has none.
  [[nodiscard]] const Tensor* neutral(std::string_view subject) const {
    for (const auto& [name, face] : neutrals)
      if (name == subject) return &face;
    return nullptr;
  }
};

}  // namespace mien
