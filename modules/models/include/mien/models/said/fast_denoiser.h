#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "mien/models/said/network.h"
#include "mien/models/said/sampling.h"
#include "mien/nn/plain_weights.h"
#include "mien/nn/runtime_operations.h"

namespace mien::said {

/// The denoiser rewritten for walks of many steps, with nothing approximated (docs/said.md): equal to
/// Denoiser up to float32 rounding, or to the rounding of the backend.
///
/// Once for a model: what a step number adds to every residual block, a table over all steps; what the null
/// condition gives through cross attention, a constant, since attention to equal frames is their value; the
/// output convolution of a transformer block multiplied into its feed-forward part. Once for a clip: keys and
/// values of the speech. Once for both branches of guidance: everything in front of the first cross
/// attention. Cross attention is a band of three keys. Immutable; may be shared by threads.
class FastDenoiser {
 public:
  /// @param num_steps  T of the training: step numbers are 0 ... T - 1. @pre backend_available(backend)
  FastDenoiser(const Network<PlainWeights>& weights, std::int64_t num_steps,
               Backend backend = Backend::rowwise);
  ~FastDenoiser();
  FastDenoiser(FastDenoiser&&) noexcept;
  FastDenoiser& operator=(FastDenoiser&&) noexcept;

  [[nodiscard]] const Sizes& sizes() const;
  /// Network::context(): features [N, speech] -> [N, D].
  [[nodiscard]] Tensor context(const Tensor& features) const;

  /// What a clip gives to the blocks.
  struct Speech {
    std::vector<Tensor> keys_and_values;  ///< by transformer block [T, 2 C]
    std::vector<KeyRange> ranges;         ///< by frame of motion
  };
  /// @param context  [T, D]
  [[nodiscard]] Speech listen(const Tensor& context, std::int64_t num_frames) const;

  /// For sample(): takes and branches are computed side by side on up to `num_threads` threads; bits do not
  /// depend on them. The denoiser and `speech` (one for all takes, or one each) are borrowed.
  [[nodiscard]] NoiseNetwork network(const std::vector<Speech>& speech, int num_threads) const;

 private:
  struct Packed;
  std::unique_ptr<Packed> packed_;
};

}  // namespace mien::said
