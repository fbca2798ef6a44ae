#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace mien {

/// The linear system of a chain of T frames of K channels, the minimum of
///
///   sum over n of  1/2 x_n^T (P + diag(d_n)) x_n - r_n^T x_n  +  1/2 sum over n, i of w_ni (x_{n+1,i} -
///   x_ni)^2
///
/// with d [T, K] and w [T - 1, K], both >= 0. Neighbouring frames meet channel by channel only, so that
/// eliminating a frame needs its inverse and nothing else. d and w may differ by many orders of magnitude: an
/// interior point method makes them huge where a limit holds. Time T K^3; memory per frame about 4 K^2 bytes
/// for the lower half of one inverse, in blocks of 8 x 8.
class FrameChain {
 public:
  /// @param quadratic  P [K, K] symmetric
  FrameChain(std::span<const double> quadratic, std::int64_t num_channels, std::int64_t num_frames);

  /// False when the system is not positive definite.
  [[nodiscard]] bool factor(std::span<const double> d, std::span<const double> w);
  /// x [T, K] holds r and becomes the solution; change [T - 1, K] becomes x_{n+1} - x_n, to its own last
  /// digits also where w ties two frames together. @pre factor() was the last to run, with success
  void solve(std::span<double> x, std::span<double> change) const;

 private:
  [[nodiscard]] const double* inverse(std::int64_t n) const { return inverses_.data() + n * size_; }

  std::int64_t num_channels_, num_frames_;
  std::int64_t num_blocks_, width_, size_;  // of one padded matrix
  std::vector<double> quadratic_;           // blocks; ones on the diagonal of what is padded
  // Of each frame n after those before it are eliminated:
  std::vector<double> inverses_;   // [T] (A_n + W_n)^-1 in blocks
  std::vector<double> diagonals_;  // [T, width] diagonal of A_n, without the ties to the frame after it
  std::vector<double> coupling_;   // [T - 1, width] w, 0 in the padding
};

}  // namespace mien
