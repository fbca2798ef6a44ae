#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "mien/models/facediffuser/network.h"
#include "mien/nn/runtime_operations.h"

namespace mien::facediffuser {

/// A denoiser rewritten for sampling, with nothing approximated (docs/facediffuser.md, "The latent loop").
///
/// x_t enters V only through its first linear map and a filter; the update of a sampler is affine, and so is
/// the last layer. So a sampler may carry y = A x_t, [2 L] numbers a frame instead of D, with A = filter *
/// W_in: the estimate A x0 is M g + m with M = A W_out, and noise A z of white z is drawn as C xi with C C^T
/// = A A^T. B has few channels: its y is x_t itself.
///
/// The first product of the GRU is split by what its input depends on: speech (once a frame), the step (once
/// a walk) and y. The normalisation before it couples the three only through the mean and variance of a row.
struct FoldedDenoiser {
  std::int64_t state_width = 0;   ///< of y
  std::int64_t noise_width = 0;   ///< of the noise that is drawn for a frame: 2 L or D
  std::int64_t output_width = 0;  ///< D
  std::int64_t hidden = 0;        ///< G
  std::int64_t token_width = 0;   ///< of the input of the GRU
  bool is_normalised = true;
  std::int64_t style_width = 0;  ///< of what a lane's style scales: states, or tokens of speech; 0 for B
  bool styles_speech = false;    ///< the latter

  std::vector<GruLayer<Tensor>> layers;
  PackedMatrix speech_gates, noise_gates, time_gates;  ///< [3 G, tokens], scaled by gamma
  Tensor mean_gates;                                   ///< [3 G]: W_ih gamma
  Tensor constant_gates;                               ///< [3 G]: W_ih beta + b_ih
  Tensor state_bias;       ///< [2 L] before the rectifier; empty for B, where y is the token itself
  PackedMatrix estimate;   ///< [state_width, G]
  PackedMatrix noise_map;  ///< [state_width, noise_width]; empty for B
  PackedMatrix output;     ///< [D, G]
  Tensor output_bias;      ///< [D]

  std::function<Tensor(const Tensor& aligned)> speech_tokens;
  std::function<Tensor(std::int64_t network_step)> time_token;
  /// Values of the mesh or channels [M, D] as y, without constants.
  std::function<Tensor(const Tensor& rows)> to_state;

  [[nodiscard]] bool is_latent() const { return state_bias.count() > 0; }
};

/// Work of one second or two at the size of BIWI; done once for a model.
FoldedDenoiser fold(std::shared_ptr<const VertexDenoiser<Tensor>> network, int num_threads = 1);
FoldedDenoiser fold(std::shared_ptr<const BeatDenoiser<Tensor>> network);
FoldedDenoiser fold(std::shared_ptr<const DammDenoiser<Tensor>> network);

}  // namespace mien::facediffuser
