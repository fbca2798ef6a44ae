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
/// interior point method makes them huge where a limit holds. Time T K^3, memory T K^2.
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
  [[nodiscard]] const double* packed(const std::vector<double>& triangles, std::int64_t n) const {
    return triangles.data() + n * num_channels_ * (num_channels_ + 1) / 2;
  }

  std::int64_t num_channels_, num_frames_, stride_;
  std::vector<double> quadratic_;  // [K, stride]
  // Of each frame n after those before it are eliminated, lower triangles [T, K (K + 1) / 2]:
  std::vector<double> frames_;    // A_n, without the ties to the frame after it
  std::vector<double> inverses_;  // (A_n + W_n)^-1
  std::vector<double> coupling_;  // [T - 1, K]
};

/// Inverse of a symmetric positive definite matrix, in place (Gauss-Jordan). @param a  [K, stride], stride >=
/// K; what lies between K and stride is overwritten. False when a pivot is not positive.
bool invert(double* a, std::int64_t num_rows, std::int64_t stride);

}  // namespace mien
