#include "mien/metrics/baselines.h"

#include <algorithm>

#include "mien/base/random.h"
#include "mien/metrics/closures.h"

namespace mien {
namespace {

constexpr double kClosureMarginSeconds = 0.017;

Aperture open_mouth(std::span<const double> e) {
  Aperture out;
  for (const double x : e) out.values.push_back(0.12 + 0.4 * x);
  return out;
}

void close_between(Aperture& aperture, double start, double end) {
  for (std::size_t n = 0; n < aperture.values.size(); ++n) {
    const double t = static_cast<double>(n) / kMetricFps;
    if (t >= start && t <= end) aperture.values[n] = 0;
  }
}

}  // namespace

Aperture oracle_aperture(std::span<const double> e, const SpeechLabels& labels, double delay_s) {
  Aperture out = open_mouth(e);
  for (const ClosureEvent& event : closure_events(labels)) {
    if (event.doubtful) continue;
    close_between(out, event.window.start - kClosureMarginSeconds + delay_s,
                  event.window.end + kClosureMarginSeconds + delay_s);
  }
  return out;
}

Aperture loudness_aperture(std::span<const double> e) {
  Aperture out;
  for (const double x : e) out.values.push_back(0.5 * x);
  return out;
}

Aperture steep_loudness_aperture(std::span<const double> e) {
  Aperture out;
  for (const double x : e) out.values.push_back(0.5 * std::clamp(1.6 * x - 0.6, 0.0, 1.0));
  return out;
}

Aperture random_aperture(std::span<const double> e, const SpeechLabels& labels, std::uint64_t seed) {
  Aperture out = open_mouth(e);
  Rng rng(seed);
  const double seconds = static_cast<double>(e.size()) / kMetricFps;
  for (const ClosureEvent& event : closure_events(labels)) {
    if (event.doubtful) continue;
    const double duration = event.window.end - event.window.start;
    const double start = rng.uniform(0, std::max(0.0, seconds - duration));
    close_between(out, start - kClosureMarginSeconds, start + duration + kClosureMarginSeconds);
  }
  return out;
}

Aperture shut_aperture(std::size_t num_frames) {
  return {ApertureVariant::curves, std::vector<double>(num_frames, 0.0)};
}

}  // namespace mien
