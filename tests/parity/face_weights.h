#pragma once
#include <memory>
#include <string>
#include <variant>

#include "fixture.h"
#include "mien/models/facediffuser/folded_denoiser.h"
#include "mien/models/facediffuser/network.h"
#include "mien/models/facediffuser/plain_sampler.h"
#include "mien/models/runtime_parameters.h"

namespace mien::parity {

/// A network filled from the recorded weights of a case; the speech encoder's are left to its own tests.
template <class Network>
Network loaded(const Fixture& weights, Network network) {
  LoadRuntime load(weights.file());
  load.leave_out("audio_encoder.");
  network.visit(load);
  const Status status = load.finish();
  if (!status) throw std::runtime_error(status.error().message());
  return network;
}

using AnyDenoiser = std::variant<facediffuser::VertexDenoiser<Tensor>, facediffuser::BeatDenoiser<Tensor>,
                                 facediffuser::DammDenoiser<Tensor>>;

/// A recorded case of FaceDiffuser: its network, and the conditions of its inputs.
struct DiffuserCase {
  explicit DiffuserCase(const std::string& name);
  std::string name;
  AnyDenoiser network;
  Fixture forward;
  Tensor aligned_speech;  ///< [N, f H]
  facediffuser::Conditions<Tensor> given;
  std::int64_t num_steps;  ///< T, from the configuration

  [[nodiscard]] Fixture open(const std::string& stage) const {
    return Fixture("facediffuser", name + "." + stage + ".safetensors");
  }
  [[nodiscard]] Tensor predict_x0(const Tensor& x_t, std::int64_t step) const;
  [[nodiscard]] bool is_latent() const;
  [[nodiscard]] std::shared_ptr<const facediffuser::FoldedDenoiser> folded() const;
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
