#include <algorithm>
#include <cmath>

#include "mien/corpus/gestures.h"

namespace mien {
namespace {

constexpr double kIntervalSpread = 0.65;  // sd of the logarithm
constexpr double kMinIntervalS = 0.35;
constexpr double kMoveProbability = 0.5, kMoveReachS = 0.4;
constexpr double kLargeShiftDeg = 8, kShiftProbability = 0.25;
constexpr double kDoubleProbability = 0.06;
constexpr double kMinSeparationS = 0.25;  // a lid that is still moving does not start again

// A random instant of the pauses within kMoveReachS of t, or t when there is none.
double moved_into_pause(double t, const std::vector<TimeSpan>& pauses, Rng& rng) {
  double length = 0;
  const auto overlap = [&](const TimeSpan& p) {
    return TimeSpan{std::max(p.start_s, t - kMoveReachS), std::min(p.end_s, t + kMoveReachS)};
  };
  for (const TimeSpan& p : pauses) length += std::max(0.0, overlap(p).end_s - overlap(p).start_s);
  if (length <= 0) return t;
  double position = rng.uniform(0, length);
  for (const TimeSpan& p : pauses) {
    const TimeSpan part = overlap(p);
    const double d = part.end_s - part.start_s;
    if (d <= 0) continue;
    if (position < d) return part.start_s + position;
    position -= d;
  }
  return t;
}

}  // namespace

std::vector<BlinkEvent> draw_blinks(const BlinkContext& context, Rng& rng) {
  std::vector<double> onsets;
  const auto blink_at = [&](double t) {
    onsets.push_back(t);
    if (rng.chance(kDoubleProbability)) onsets.push_back(t + rng.uniform(0.30, 0.45));
  };
  const double mean = 60 / context.blinks_per_minute;
  const double mu = std::log(mean) - kIntervalSpread * kIntervalSpread / 2;
  const auto interval = [&] { return std::max(kMinIntervalS, rng.log_normal(mu, kIntervalSpread)); };
  for (double t = -rng.uniform(0, mean) + interval(); t < context.seconds; t += interval()) {
    const bool may_move = rng.chance(kMoveProbability);
    blink_at(may_move ? moved_into_pause(t, context.pauses, rng) : t);
  }
  for (const GazeShift& shift : context.shifts)
    if (shift.deg > kLargeShiftDeg && rng.chance(kShiftProbability)) blink_at(shift.end_s);

  std::sort(onsets.begin(), onsets.end());
  std::vector<BlinkEvent> events;
  for (const double t : onsets) {
    BlinkEvent event = draw_blink(rng);
    if (t < 0 || t >= context.seconds) continue;
    if (!events.empty() && t - events.back().onset_s < kMinSeparationS) continue;
    event.onset_s = t;
    events.push_back(event);
  }
  return events;
}

}  // namespace mien
