#pragma once
#include <array>
#include <span>
#include <vector>

namespace mien::head {

/// Cubic 3u^2 - 2u^3 of u = (x - from) / (to - from) held in [0, 1]. `from` may be above `to`.
double smooth_step(double from, double to, double x);

/// exp(-((x - centre) / width)^2).
double gauss(double x, double centre, double width);

/// Piecewise linear function through (xs[i], ys[i]); the end values hold. @pre xs ascending, sizes equal
double interpolate(double x, std::span<const double> xs, std::span<const double> ys);

/// count values from `first` to `last`, both included.
std::vector<double> linear_space(double first, double last, int count);

/// Several natural cubic splines (second derivative zero at both ends) over the same knots.
class NaturalSplines {
 public:
  /// @param knots   [K] strictly increasing
  /// @param values  [C][K] one row a curve
  NaturalSplines(std::vector<double> knots, std::vector<std::vector<double>> values);
  /// out[c] = curve c at t. @pre out.size() == C
  void evaluate(double t, std::span<double> out) const;

 private:
  std::vector<double> knots_;
  std::vector<std::vector<double>> values_;
  std::vector<std::vector<double>> curvature_;  // [C][K] second derivatives at the knots
};

/// Cubic Hermite curve whose slopes are weighted harmonic means (Fritsch and Butland 1984): it never
/// overshoots its points, which keeps the nose's ridge free of waves.
class MonotoneCurve {
 public:
  MonotoneCurve(std::vector<double> knots, std::vector<double> values);
  double operator()(double x) const;

 private:
  std::vector<double> knots_, values_, slopes_;
};

}  // namespace mien::head
