#pragma once
#include <cstdint>
#include <vector>

#include "mien/models/probtalk3d/draw_options.h"
#include "mien/models/probtalk3d/network.h"
#include "mien/nn/runtime_operations.h"

namespace mien::probtalk3d {

/// Several motions from one latent, which is predicted once: extra takes cost a draw and the decoder.
class Takes {
 public:
  /// @param network  outlives the object. @param z [N, D], N >= 2
  Takes(const Network<Tensor>& network, Tensor z, const DrawOptions& options);
  /// The take of this seed in the normalised range, [N, C]. The same whatever was asked before; safe from
  /// many threads.
  [[nodiscard]] Tensor take(std::uint64_t seed) const;
  /// The codes of a take; empty in the Gaussian variant.
  [[nodiscard]] std::vector<std::int64_t> codes(std::uint64_t seed) const;

 private:
  const Network<Tensor>& network_;
  DrawOptions options_;
  Tensor z_;
  std::vector<std::int64_t> nearest_;
  std::vector<float> probabilities_;  ///< [codes of the clip, K]
  Tensor mean_, logvar_;
};

}  // namespace mien::probtalk3d
