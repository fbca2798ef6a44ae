#include "mien/metrics/face_events.h"

#include <algorithm>
#include <cmath>

#include "mien/core/arkit.h"
#include "mien/metrics/aperture.h"
#include "mien/metrics/regions.h"
#include "undefined.h"

namespace mien {
namespace {

constexpr double kBlinkLevel = 0.5;
constexpr double kBrowRise = 0.06;
constexpr std::int64_t kBrowRiseFrames = 24;  // 0.4 s
constexpr double kNodDeg = 1.0;
constexpr std::int64_t kNodFrames = 18;  // 0.3 s
constexpr std::int64_t kPeakFrames = 9;  // largest within +-0.15 s
constexpr double kAccentToleranceSeconds = 0.150;
constexpr double kContactDeg = 3.0;
constexpr double kMaxHorizontalDeg = 33, kMaxVerticalDeg = 28;  // gaze at coefficient 1, corpus section 7
constexpr std::size_t kPitchChannel = kNumArkit + 1;

std::vector<double> lids(const Motion& motion) {
  std::vector<double> out = channel_values(motion, arkit_index("eyeBlinkLeft"));
  const std::vector<double> right = channel_values(motion, arkit_index("eyeBlinkRight"));
  for (std::size_t n = 0; n < out.size(); ++n) out[n] = (out[n] + right[n]) / 2;
  return out;
}

double seconds_of(std::size_t frames) { return static_cast<double>(frames) / kMetricFps; }

// The blink whose rise through the level ends at frame `cross`.
DetectedBlink measure_blink(const std::vector<double>& lid, std::size_t cross) {
  std::size_t onset = cross;
  while (onset > 0 && lid[onset - 1] < lid[onset]) --onset;
  std::size_t peak = cross;
  for (std::size_t n = cross; n < lid.size() && lid[n] >= kBlinkLevel; ++n)
    if (lid[n] > lid[peak]) peak = n;
  const double base = lid[onset], low = base + 0.1 * (lid[peak] - base),
               high = base + 0.9 * (lid[peak] - base);
  std::size_t leaves = onset, arrives = peak, releases = peak, open = peak;
  while (leaves < peak && lid[leaves + 1] <= low) ++leaves;
  while (arrives > onset && lid[arrives - 1] >= high) --arrives;
  while (releases + 1 < lid.size() && lid[releases + 1] >= high) ++releases;
  open = releases;
  while (open + 1 < lid.size() && lid[open] > low && lid[open + 1] <= lid[open]) ++open;
  return {seconds_of(cross), seconds_of(onset), seconds_of(arrives - leaves), seconds_of(open - releases)};
}

// Frames at which x is the largest within +-kPeakFrames (the first of equals) and at least `rise` above its
// smallest value of the `before` frames that lead there.
std::vector<double> peaks_after_rise(const std::vector<double>& x, double rise, std::int64_t before) {
  std::vector<double> times;
  const auto count = static_cast<std::int64_t>(x.size());
  const auto at = [&](std::int64_t n) { return x[static_cast<std::size_t>(n)]; };
  for (std::int64_t n = 0; n < count; ++n) {
    double lowest = at(n);
    for (std::int64_t k = std::max<std::int64_t>(0, n - before); k < n; ++k) lowest = std::min(lowest, at(k));
    if (at(n) - lowest < rise) continue;
    bool peak = true;
    for (std::int64_t k = std::max<std::int64_t>(0, n - kPeakFrames);
         k <= std::min(count - 1, n + kPeakFrames); ++k)
      peak &= k < n ? at(k) < at(n) : at(k) <= at(n);
    if (peak) times.push_back(static_cast<double>(n) / kMetricFps);
  }
  return times;
}

// Whether a sorted list of times holds one within the tolerance of t.
bool met(std::span<const double> sorted, double t) {
  const auto first = std::lower_bound(sorted.begin(), sorted.end(), t - kAccentToleranceSeconds);
  return first != sorted.end() && *first <= t + kAccentToleranceSeconds;
}

void append(std::vector<double>& to, const std::vector<double>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

std::vector<DetectedBlink> detect_blinks(const Motion& motion) {
  require_performance(motion);
  const std::vector<double> lid = lids(motion);
  std::vector<DetectedBlink> out;
  for (std::size_t n = 1; n < lid.size(); ++n)
    if (lid[n - 1] < kBlinkLevel && lid[n] >= kBlinkLevel) out.push_back(measure_blink(lid, n));
  return out;
}

BlinkScore& BlinkScore::operator+=(const BlinkScore& other) {
  seconds += other.seconds;
  blinks += other.blinks;
  in_pauses += other.in_pauses;
  append(intervals_s, other.intervals_s);
  append(closings_s, other.closings_s);
  append(openings_s, other.openings_s);
  return *this;
}

double BlinkScore::per_minute() const { return ratio(60.0 * static_cast<double>(blinks), seconds); }
double BlinkScore::share_in_pauses() const {
  return ratio(static_cast<double>(in_pauses), static_cast<double>(blinks));
}

BlinkScore score_blinks(const Motion& motion, std::span<const TimeInterval> pauses) {
  BlinkScore out;
  out.seconds = motion.seconds();
  double previous = -1;
  for (const DetectedBlink& blink : detect_blinks(motion)) {
    ++out.blinks;
    for (const TimeInterval& pause : pauses)
      out.in_pauses += blink.onset >= pause.start && blink.onset < pause.end;
    if (previous >= 0) out.intervals_s.push_back(blink.time - previous);
    out.closings_s.push_back(blink.closing);
    out.openings_s.push_back(blink.opening);
    previous = blink.time;
  }
  return out;
}

std::vector<double> detect_brow_raises(const Motion& motion) {
  require_performance(motion);
  return peaks_after_rise(channel_values(motion, arkit_index("browInnerUp")), kBrowRise, kBrowRiseFrames);
}

std::vector<double> detect_nods(const Motion& motion) {
  require_performance(motion);
  std::vector<double> down = channel_values(motion, kPitchChannel);
  for (double& pitch : down) pitch = -pitch;  // + is up
  return peaks_after_rise(down, kNodDeg, kNodFrames);
}

AccentScore& AccentScore::operator+=(const AccentScore& other) {
  accents += other.accents;
  accents_met += other.accents_met;
  instants += other.instants;
  instants_met += other.instants_met;
  return *this;
}

double AccentScore::rate() const {
  return ratio(static_cast<double>(accents_met), static_cast<double>(accents));
}
double AccentScore::lift() const {
  return ratio(rate(), ratio(static_cast<double>(instants_met), static_cast<double>(instants)));
}

AccentScore score_accents(std::span<const double> event_times, std::span<const double> accents,
                          std::int64_t num_frames) {
  std::vector<double> sorted(event_times.begin(), event_times.end());
  std::sort(sorted.begin(), sorted.end());
  AccentScore out;
  for (const double accent : accents) ++out.accents, out.accents_met += met(sorted, accent);
  for (std::int64_t n = 0; n < num_frames; ++n)
    ++out.instants, out.instants_met += met(sorted, static_cast<double>(n) / kMetricFps);
  return out;
}

GazeScore& GazeScore::operator+=(const GazeScore& other) {
  append(contact_s, other.contact_s);
  append(away_s, other.away_s);
  frames += other.frames;
  away_frames += other.away_frames;
  return *this;
}

double GazeScore::share_away() const {
  return ratio(static_cast<double>(away_frames), static_cast<double>(frames));
}

GazeScore score_gaze(const Motion& motion) {
  require_performance(motion);
  static const std::size_t out_l = arkit_index("eyeLookOutLeft"), in_l = arkit_index("eyeLookInLeft"),
                           up_l = arkit_index("eyeLookUpLeft"), down_l = arkit_index("eyeLookDownLeft"),
                           out_r = arkit_index("eyeLookOutRight"), in_r = arkit_index("eyeLookInRight"),
                           up_r = arkit_index("eyeLookUpRight"), down_r = arkit_index("eyeLookDownRight");
  GazeScore out;
  std::int64_t started =
      -1;  // first frame of the current stretch; -1 while the one cut by the beginning lasts
  bool was_away = false;
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    const auto f = motion.frame(n);
    const double x = kMaxHorizontalDeg * 0.5 * ((f[out_l] + f[in_r]) - (f[in_l] + f[out_r]));
    const double y = kMaxVerticalDeg * 0.5 * ((f[up_l] + f[up_r]) - (f[down_l] + f[down_r]));
    const bool away = std::hypot(x, y) >= kContactDeg;
    ++out.frames, out.away_frames += away;
    if (n > 0 && away != was_away) {
      if (started >= 0)
        (was_away ? out.away_s : out.contact_s).push_back(static_cast<double>(n - started) / kMetricFps);
      started = n;
    }
    was_away = away;
  }
  return out;
}

}  // namespace mien
