#pragma once
#include <vector>

#include "frame_chain.h"
#include "scaled_qp.h"

namespace mien {

/// Primal-dual interior point method with predictor and corrector (Mehrotra 1992) on a ScaledQp. The slacks
/// are eliminated, which leaves the system of a FrameChain.
class InteriorPoint {
 public:
  /// Starts in the middle of the box. @param problem, chain  outlive the object
  InteriorPoint(const ScaledQp& problem, FrameChain& chain);

  /// One predictor and corrector step. False when the system cannot be factored.
  [[nodiscard]] bool iterate();

  [[nodiscard]] double stationarity() const { return largest(gradient_); }
  /// Mean slack times multiplier.
  [[nodiscard]] double complementarity() const { return gap(0); }
  [[nodiscard]] const std::vector<double>& x() const { return x_; }
  [[nodiscard]] const Multipliers& multipliers() const { return multipliers_; }

 private:
  /// One kind of limits, whose slack moves by sign * move[i].
  struct Kind {
    std::vector<double> slack, multiplier_step;
    double sign = 1;
    bool is_pair = false;
  };
  [[nodiscard]] std::vector<double>& multiplier(int kind);
  [[nodiscard]] const std::vector<double>& multiplier(int kind) const;
  [[nodiscard]] const std::vector<double>& moves(int kind) const {
    return kinds_[kind].is_pair ? change_ : dx_;
  }
  void weigh();
  void direction(double target, bool second_order);
  [[nodiscard]] double longest_step() const;
  [[nodiscard]] double gap(double step) const;
  void advance(double step);

  const ScaledQp& problem_;
  FrameChain& chain_;
  std::vector<double> x_, gradient_, diagonal_, coupling_;
  std::vector<double> dx_, change_;
  Kind kinds_[4];  // below, above, rising, falling
  Multipliers multipliers_;
};

}  // namespace mien
