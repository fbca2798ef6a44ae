#include "time_shape.h"

#include <cmath>
#include <numbers>

#include "mien/corpus/articulation.h"

namespace mien {
namespace {

// Window of `width` values with sum 1, no zero at the ends.
std::vector<float> hann_window(int width) {
  std::vector<float> window(static_cast<std::size_t>(width));
  double sum = 0;
  for (int k = 0; k < width; ++k) {
    const double s = std::sin(std::numbers::pi * (k + 1) / (width + 1));
    window[static_cast<std::size_t>(k)] = static_cast<float>(s * s);
    sum += s * s;
  }
  for (float& w : window) w = static_cast<float>(w / sum);
  return window;
}

// Moving weighted sum without padding: out[n] = sum over k of window[k] values[n + k].
std::vector<float> weighted(const std::vector<float>& values, const std::vector<float>& window) {
  std::vector<float> out(values.size() - window.size() + 1);
  for (std::size_t n = 0; n < out.size(); ++n) {
    float sum = 0;
    for (std::size_t k = 0; k < window.size(); ++k) sum += window[k] * values[n + k];
    out[n] = sum;
  }
  return out;
}

}  // namespace

std::vector<float> slow_walk(double sigma, double tau_s, std::int64_t num, Rng& rng) {
  static const std::vector<float> window = hann_window(15);
  if (num <= 0) return {};
  const double keep = std::exp(-1 / (kCorpusFps * tau_s));
  const double step = sigma * std::sqrt(1 - keep * keep);
  std::vector<float> walk(static_cast<std::size_t>(num) + window.size() - 1);
  double x = rng.normal(0, sigma);
  for (float& value : walk) {
    value = static_cast<float>(x);
    x = keep * x + rng.normal(0, step);
  }
  return weighted(walk, window);
}

std::vector<float> hann_smoothed(const std::vector<float>& values, int width) {
  if (values.empty()) return {};
  const auto half = static_cast<std::size_t>(width / 2);
  std::vector<float> padded(half, values.front());
  padded.insert(padded.end(), values.begin(), values.end());
  padded.insert(padded.end(), half, values.back());
  return weighted(padded, hann_window(width));
}

}  // namespace mien
