#include "head/curves.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"

namespace mien::head {
namespace {

// Index i of the interval [knots[i], knots[i + 1]] that holds x; the outer intervals extend to both sides.
std::size_t interval_of(const std::vector<double>& knots, double x) {
  const auto above = std::upper_bound(knots.begin() + 1, knots.end() - 1, x);
  return static_cast<std::size_t>(above - knots.begin()) - 1;
}

// Second derivatives at the knots of the natural spline: the tridiagonal system by elimination.
std::vector<double> natural_curvature(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  std::vector<double> m(n, 0.0), upper(n, 0.0), rhs(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double left = x[i] - x[i - 1], right = x[i + 1] - x[i];
    const double pivot = 2 * (left + right) - left * upper[i - 1];
    upper[i] = right / pivot;
    rhs[i] = (6 * ((y[i + 1] - y[i]) / right - (y[i] - y[i - 1]) / left) - left * rhs[i - 1]) / pivot;
  }
  for (std::size_t i = n - 2; i > 0; --i) m[i] = rhs[i] - upper[i] * m[i + 1];
  return m;
}

bool same_sign(double a, double b) { return (a > 0 && b > 0) || (a < 0 && b < 0); }

// One-sided slope at an end from the two intervals next to it, limited so that the curve stays monotone
// there.
double end_slope(double width0, double width1, double chord0, double chord1) {
  const double slope = ((2 * width0 + width1) * chord0 - width0 * chord1) / (width0 + width1);
  if (!same_sign(slope, chord0)) return 0;
  if (!same_sign(chord0, chord1) && std::abs(slope) > 3 * std::abs(chord0)) return 3 * chord0;
  return slope;
}

}  // namespace

double smooth_step(double from, double to, double x) {
  const double u = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

double gauss(double x, double centre, double width) {
  const double u = (x - centre) / width;
  return std::exp(-u * u);
}

double interpolate(double x, std::span<const double> xs, std::span<const double> ys) {
  if (x <= xs.front()) return ys.front();
  if (x >= xs.back()) return ys.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(xs.begin(), xs.end(), x) - xs.begin()) - 1;
  return ys[i] + (ys[i + 1] - ys[i]) / (xs[i + 1] - xs[i]) * (x - xs[i]);
}

std::vector<double> linear_space(double first, double last, int count) {
  std::vector<double> values(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    values[static_cast<std::size_t>(i)] = first + i * ((last - first) / (count - 1));
  values.back() = last;
  return values;
}

NaturalSplines::NaturalSplines(std::vector<double> knots, std::vector<std::vector<double>> values)
    : knots_(std::move(knots)), values_(std::move(values)) {
  for (const auto& curve : values_) {
    contract(curve.size() == knots_.size() && knots_.size() >= 3, "NaturalSplines: sizes differ");
    curvature_.push_back(natural_curvature(knots_, curve));
  }
}

void NaturalSplines::evaluate(double t, std::span<double> out) const {
  contract(out.size() == values_.size(), "NaturalSplines: one output per curve expected");
  const std::size_t i = interval_of(knots_, t);
  const double width = knots_[i + 1] - knots_[i];
  const double b = (t - knots_[i]) / width, a = 1 - b;
  const double wa = (a * a * a - a) * width * width / 6, wb = (b * b * b - b) * width * width / 6;
  for (std::size_t c = 0; c < out.size(); ++c)
    out[c] = a * values_[c][i] + b * values_[c][i + 1] + wa * curvature_[c][i] + wb * curvature_[c][i + 1];
}

MonotoneCurve::MonotoneCurve(std::vector<double> knots, std::vector<double> values)
    : knots_(std::move(knots)), values_(std::move(values)), slopes_(knots_.size(), 0.0) {
  const std::size_t n = knots_.size();
  contract(values_.size() == n && n >= 3, "MonotoneCurve: three points or more, sizes equal");
  std::vector<double> width(n - 1), chord(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    width[i] = knots_[i + 1] - knots_[i];
    chord[i] = (values_[i + 1] - values_[i]) / width[i];
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (!same_sign(chord[i - 1], chord[i])) continue;  // a turning point is flat
    const double w1 = 2 * width[i] + width[i - 1], w2 = width[i] + 2 * width[i - 1];
    slopes_[i] = (w1 + w2) / (w1 / chord[i - 1] + w2 / chord[i]);
  }
  slopes_[0] = end_slope(width[0], width[1], chord[0], chord[1]);
  slopes_[n - 1] = end_slope(width[n - 2], width[n - 3], chord[n - 2], chord[n - 3]);
}

double MonotoneCurve::operator()(double x) const {
  const std::size_t i = interval_of(knots_, x);
  const double width = knots_[i + 1] - knots_[i], u = (x - knots_[i]) / width;
  const double u2 = u * u, u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * values_[i] + (3 * u2 - 2 * u3) * values_[i + 1] +
         width * ((u3 - 2 * u2 + u) * slopes_[i] + (u3 - u2) * slopes_[i + 1]);
}

}  // namespace mien::head
