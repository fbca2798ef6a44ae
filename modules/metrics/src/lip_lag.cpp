#include "mien/metrics/lip_lag.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mien/metrics/aperture.h"
#include "mien/metrics/loudness.h"
#include "mien/metrics/statistics.h"
#include "undefined.h"

namespace mien {
namespace {

constexpr std::size_t kLeastFrames = 60;

// Where the parabola through three neighbouring values is largest, -0.5 ... 0.5 from the middle one.
double parabola_top(double before, double top, double after) {
  const double bend = before - 2 * top + after;
  return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
}

}  // namespace

LipLag lip_lag(std::span<const double> aperture, std::span<const double> level_db) {
  constexpr std::size_t kMargin = kMaxLipLagFrames;
  const LipLag none{kNan, kNan, kNan};
  const std::size_t count = std::min(aperture.size(), level_db.size());
  if (count < kLeastFrames + 2 * kMargin) return none;
  const std::vector<double> lips = smooth_30_ms(aperture), loud = loudness(level_db);
  const std::size_t scored = count - 2 * kMargin;
  std::vector<double> r;
  for (std::size_t shift = 0; shift <= 2 * kMargin; ++shift)
    r.push_back(pearson(std::span(loud).subspan(kMargin, scored), std::span(lips).subspan(shift, scored)));
  if (std::ranges::any_of(r, [](double x) { return !std::isfinite(x); })) return none;
  const auto top = static_cast<std::size_t>(std::ranges::max_element(r) - r.begin());
  const double part = top == 0 || top + 1 == r.size() ? 0 : parabola_top(r[top - 1], r[top], r[top + 1]);
  const double frames = static_cast<double>(top) - static_cast<double>(kMargin) + part;
  return {1000 * frames / kMetricFps, r[top], r[top] - median(r)};
}

}  // namespace mien
