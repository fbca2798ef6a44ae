#pragma once

namespace mien::probtalk3d {

/// How a take gets from the predicted latent to its own.
struct DrawOptions {
  /// Codes are drawn from softmax(-distance / temperature); 0: the nearest, the same in all takes. The
  /// authors recommend 0.1 to 0.5.
  double temperature = 0.2;
  int place = 1;  ///< the k-th code of a draw without replacement (their k)
  double noise_factor =
      20;  ///< of the Gaussian variant: times its deviation; 0: the mean. They recommend 1 to 40
};

}  // namespace mien::probtalk3d
