#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "mien/base/random.h"

namespace mien {

/// S(u) = u^2 (3 - 2u), clamped to 0 ... 1.
inline double smooth_step(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

/// Rises during `rise_s` up to `start_s`, is 1 until `end_s`, falls during `fall_s` (specification, 4.2).
struct Bump {
  double start_s, end_s, rise_s, fall_s;

  [[nodiscard]] double at(double t) const {
    return smooth_step((t - start_s + rise_s) / rise_s) * smooth_step((end_s + fall_s - t) / fall_s);
  }
};

/// Calls visit(n, value) for every sample n of 0 ... num-1 at n / rate_hz where the bump is not zero.
template <class Visit>
void for_each_sample(const Bump& bump, double rate_hz, std::int64_t num, Visit&& visit) {
  const double first = std::max(0.0, std::ceil((bump.start_s - bump.rise_s) * rate_hz));
  const double last =
      std::min(static_cast<double>(num) - 1, std::floor((bump.end_s + bump.fall_s) * rate_hz));
  for (double n = first; n <= last; ++n) visit(static_cast<std::size_t>(n), bump.at(n / rate_hz));
}

/// A slow random walk around zero (Ornstein-Uhlenbeck, specification section 7): spread sigma, correlation
/// time tau, at 60 fps, smoothed with a 15-frame Hann window. Draws num + 14 normal values.
std::vector<float> slow_walk(double sigma, double tau_s, std::int64_t num, Rng& rng);

/// Running mean with a Hann window of `width` frames (odd); the end values hold beyond the ends.
std::vector<float> hann_smoothed(const std::vector<float>& values, int width);

}  // namespace mien
