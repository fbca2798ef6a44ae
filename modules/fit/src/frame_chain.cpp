#include "frame_chain.h"

#include <algorithm>

#include "mien/base/contract.h"
#include "symmetric_blocks.h"

namespace mien {

FrameChain::FrameChain(std::span<const double> quadratic, std::int64_t num_channels, std::int64_t num_frames)
    : num_channels_(num_channels),
      num_frames_(num_frames),
      num_blocks_((num_channels + kBlock - 1) / kBlock),
      width_(num_blocks_ * kBlock),
      size_(block_offset(num_blocks_, 0)) {
  contract(static_cast<std::int64_t>(quadratic.size()) == num_channels * num_channels,
           "FrameChain: quadratic must be [K, K]");
  quadratic_.resize(static_cast<std::size_t>(size_));
  for (std::int64_t i = 0; i < width_; ++i)
    for (std::int64_t j = 0; j < width_; ++j) {
      const std::int64_t bi = i / kBlock, bj = j / kBlock;
      if (bj > bi) continue;
      const bool inside = i < num_channels && j < num_channels;
      quadratic_[block_offset(bi, bj) + i % kBlock * kBlock + j % kBlock] =
          inside ? quadratic[static_cast<std::size_t>(i * num_channels + j)] : (i == j ? 1.0 : 0.0);
    }
  inverses_.resize(static_cast<std::size_t>(num_frames_ * size_));
  diagonals_.resize(static_cast<std::size_t>(num_frames_ * width_));
  coupling_.resize(static_cast<std::size_t>(std::max<std::int64_t>(0, num_frames_ - 1) * width_));
}

bool FrameChain::factor(std::span<const double> d, std::span<const double> w) {
  const std::int64_t k = num_channels_;
  const auto diagonal = [](std::int64_t i) {
    return block_offset(i / kBlock, i / kBlock) + i % kBlock * (kBlock + 1);
  };
  for (std::int64_t n = 0; n + 1 < num_frames_; ++n)
    std::copy_n(w.data() + n * k, k, coupling_.data() + n * width_);
  // A_n = P + diag(d_n) + C_{n-1}, where C is what the frames before leave: W - W (A + W)^-1 W.
  std::vector<double> frame = quadratic_, next(quadratic_.size()), sums(static_cast<std::size_t>(width_)),
                      scratch(static_cast<std::size_t>(2 * width_ * kBlock));
  for (std::int64_t n = 0; n < num_frames_; ++n) {
    double* inverse = inverses_.data() + n * size_;
    for (std::int64_t i = 0; i < k; ++i)
      frame[static_cast<std::size_t>(diagonal(i))] += d[static_cast<std::size_t>(n * k + i)];
    for (std::int64_t i = 0; i < width_; ++i) diagonals_[n * width_ + i] = frame[diagonal(i)];
    std::copy(frame.begin(), frame.end(), inverse);
    if (n + 1 == num_frames_) return invert_blocks(inverse, num_blocks_, scratch.data());
    const double* ties = coupling_.data() + n * width_;
    for (std::int64_t i = 0; i < width_; ++i) inverse[diagonal(i)] += ties[i];
    if (!invert_blocks(inverse, num_blocks_, scratch.data())) return false;
    couple_blocks(quadratic_.data(), frame.data(), inverse, ties, num_blocks_, next.data(), sums.data());
    frame.swap(next);
  }
  return true;
}

void FrameChain::solve(std::span<double> x, std::span<double> change) const {
  if (num_frames_ == 0) return;
  const std::int64_t k = num_channels_;
  const auto width = static_cast<std::size_t>(width_);
  std::vector<double> here(width), product(width), far(width);
  for (std::int64_t n = 0; n + 1 < num_frames_; ++n) {
    std::copy_n(x.data() + n * k, k, here.data());
    multiply_blocks(inverse(n), num_blocks_, here.data(), product.data());
    const double* w = coupling_.data() + n * width_;
    double* after = x.data() + (n + 1) * k;
    for (std::int64_t i = 0; i < k; ++i) after[i] += w[i] * product[static_cast<std::size_t>(i)];
  }
  std::copy_n(x.data() + (num_frames_ - 1) * k, k, here.data());
  multiply_blocks(inverse(num_frames_ - 1), num_blocks_, here.data(), product.data());
  std::copy_n(product.data(), k, x.data() + (num_frames_ - 1) * k);
  // From (A + W) x_n = y + W x_{n+1}: x_{n+1} - x_n = (A + W)^-1 (A x_{n+1} - y). Off its diagonal A is
  // P - W' M' W' of the frame before, so that only its diagonal has to be kept.
  for (std::int64_t n = num_frames_ - 1; n-- > 0;) {
    double *row = x.data() + n * k, *step = change.data() + n * k;
    const double* diagonal = diagonals_.data() + n * width_;
    std::copy_n(row + k, k, here.data());
    multiply_off_diagonal(quadratic_.data(), num_blocks_, here.data(), product.data());
    for (std::int64_t i = 0; i < k; ++i) product[i] += diagonal[i] * here[i] - row[i];
    if (n > 0) {
      const double* w = coupling_.data() + (n - 1) * width_;
      for (std::int64_t i = 0; i < width_; ++i) here[i] *= w[i];
      multiply_off_diagonal(inverse(n - 1), num_blocks_, here.data(), far.data());
      for (std::int64_t i = 0; i < width_; ++i) product[i] -= w[i] * far[i];
    }
    for (std::int64_t i = k; i < width_; ++i) product[i] = 0;
    multiply_blocks(inverse(n), num_blocks_, product.data(), far.data());
    for (std::int64_t i = 0; i < k; ++i) {
      step[i] = far[i];
      row[i] = row[k + i] - far[i];
    }
  }
}

}  // namespace mien
