#include "mien/metrics/closures.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mien/metrics/statistics.h"
#include "undefined.h"

namespace mien {
namespace {

// Constants of the README's definitions, in its order.
constexpr double kScalePercentile = 90;
constexpr double kMinScale = 0.05, kMinScaleMm = 1.0;
constexpr double kClosedShare = 0.15, kMinThetaMm = 0.5;
constexpr std::int64_t kMaxOpenFramesInRun = 1;
constexpr double kOpenNearbySeconds = 0.200;
constexpr double kOpenNearbyShare = 0.20;
constexpr double kLongRunSeconds = 0.300;

double time_of(std::int64_t frame) { return static_cast<double>(frame) / kMetricFps; }

// Everything that the scoring of one recording needs at hand.
struct Scorer {
  const std::vector<double>& aperture;
  const SpeechLabels& labels;
  std::vector<std::size_t> row_of_frame;
  OpeningScale scale;
  std::vector<FrameRun> runs;
  double tolerance;

  [[nodiscard]] bool in_silence(std::int64_t n) const {
    return labels.rows[row_of_frame[static_cast<std::size_t>(n)]].is_silence();
  }
  [[nodiscard]] bool touches(const FrameRun& run, double start, double end) const {
    return time_of(run.first) <= end + tolerance && time_of(run.last) >= start - tolerance;
  }

  // Smallest or largest aperture over frames in [start - margin, end + margin]; nothing when no frame lies
  // there.
  template <class Better>
  [[nodiscard]] std::optional<double> extreme(double start, double end, double margin, Better better) const {
    std::optional<double> found;
    const auto count = static_cast<std::int64_t>(aperture.size());
    const auto guess = static_cast<std::int64_t>(std::floor((start - margin) * kMetricFps)) - 1;
    for (std::int64_t n = std::max<std::int64_t>(0, guess); n < count && time_of(n) <= end + margin; ++n) {
      if (time_of(n) < start - margin) continue;
      const double a = aperture[static_cast<std::size_t>(n)];
      if (!found || better(a, *found)) found = a;
    }
    return found;
  }

  void score_target(const ClosureEvent& event, ClosureScore& score) const {
    const auto [start, end] = event.window;
    ++score.targets;
    const auto lowest = extreme(start, end, tolerance, std::less<>());
    const auto highest = extreme(start, end, kOpenNearbySeconds, std::greater<>());
    if (!lowest || !highest || *lowest > scale.theta || *highest < scale.theta + kOpenNearbyShare * scale.r)
      return;
    ++score.hits;
    score.sealed += *lowest <= 0;
    score.depths.push_back(*lowest / scale.r);
    if (!event.timed) return;
    std::optional<double> nearest;
    for (const FrameRun& run : runs) {
      if (!touches(run, start, end)) continue;
      const double error = (time_of(run.first) + time_of(run.last)) / 2 - event.window.centre();
      if (!nearest || std::abs(error) < std::abs(*nearest)) nearest = error;
    }
    if (nearest) score.timing_errors_ms.push_back(1000 * *nearest);
  }

  [[nodiscard]] bool touches_lips_nearly_met(const FrameRun& run) const {
    for (const PhoneRow& row : labels.rows)
      if ((row.phone == "f" || row.phone == "v") && touches(run, row.start, row.end)) return true;
    return false;
  }

  void score_run(const FrameRun& run, const std::vector<ClosureEvent>& events, ClosureScore& score) const {
    const std::int64_t frames = run.last - run.first + 1;
    std::int64_t silent = 0;
    for (std::int64_t n = run.first; n <= run.last; ++n) silent += in_silence(n);
    if (2 * silent > frames) return;
    bool target = false, doubtful = false;
    for (const ClosureEvent& event : events) {
      if (!touches(run, event.window.start, event.window.end)) continue;
      (event.doubtful ? doubtful : target) = true;
    }
    if (target)
      ++score.true_positives;
    else if (!doubtful && !touches_lips_nearly_met(run))
      ++score.false_positives;
    // The small term keeps a run of exactly 18 frame steps from falling below 300 ms by rounding.
    const double seconds = time_of(run.last - run.first);
    score.false_positives += static_cast<std::int64_t>((seconds + 1e-9) / kLongRunSeconds);
  }
};

}  // namespace

OpeningScale opening_scale(const Aperture& aperture, const SpeechLabels& labels) {
  const auto rows = labels.rows_of_frames(static_cast<std::int64_t>(aperture.values.size()), kMetricFps);
  std::vector<double> in_phones;
  for (std::size_t n = 0; n < rows.size(); ++n)
    if (!labels.rows[rows[n]].is_silence()) in_phones.push_back(aperture.values[n]);
  const bool mesh = aperture.variant == ApertureVariant::mesh;
  const double smallest = mesh ? kMinScaleMm : kMinScale;
  const double r =
      in_phones.empty() ? smallest : std::max(smallest, percentile(std::move(in_phones), kScalePercentile));
  return {r, mesh ? std::max(kClosedShare * r, kMinThetaMm) : kClosedShare * r};
}

std::vector<FrameRun> closed_runs(std::span<const double> aperture, double theta) {
  std::vector<FrameRun> runs;
  for (std::int64_t n = 0; n < static_cast<std::int64_t>(aperture.size()); ++n) {
    if (!(aperture[static_cast<std::size_t>(n)] <= theta)) continue;
    if (!runs.empty() && n - runs.back().last - 1 <= kMaxOpenFramesInRun)
      runs.back().last = n;
    else
      runs.push_back({n, n});
  }
  return runs;
}

std::vector<ClosureEvent> closure_events(const SpeechLabels& labels) {
  constexpr std::uint32_t kUntimed = kEdgeStart | kEdgeEnd | kClusterStart | kClusterEnd | kMerged;
  std::vector<ClosureEvent> events;
  for (const PhoneRow& row : labels.rows) {
    if (!row.closure || (row.flags & kSameEvent) != 0) continue;
    events.push_back({*row.closure, (row.flags & kDoubtful) != 0, (row.flags & kUntimed) == 0});
  }
  return events;
}

ClosureScore& ClosureScore::operator+=(const ClosureScore& other) {
  targets += other.targets;
  hits += other.hits;
  sealed += other.sealed;
  true_positives += other.true_positives;
  false_positives += other.false_positives;
  timing_errors_ms.insert(timing_errors_ms.end(), other.timing_errors_ms.begin(),
                          other.timing_errors_ms.end());
  depths.insert(depths.end(), other.depths.begin(), other.depths.end());
  return *this;
}

double ClosureScore::hit_rate() const { return ratio(hits, targets); }
double ClosureScore::precision() const { return ratio(true_positives, true_positives + false_positives); }
double ClosureScore::f1() const {
  if (targets == 0) return kNan;
  if (hits == 0 || true_positives == 0) return 0;
  const double h = hit_rate(), p = precision();
  return 2 * p * h / (p + h);
}
double ClosureScore::sealed_share() const { return ratio(sealed, hits); }
double ClosureScore::timing_bias_ms() const { return median(timing_errors_ms); }
double ClosureScore::timing_mad_ms() const { return median_absolute_deviation(timing_errors_ms); }
double ClosureScore::depth() const { return median(depths); }

ClosureScore score_closures(const Aperture& aperture, const SpeechLabels& labels, double tolerance_s) {
  Scorer scorer{aperture.values,
                labels,
                labels.rows_of_frames(static_cast<std::int64_t>(aperture.values.size()), kMetricFps),
                opening_scale(aperture, labels),
                {},
                tolerance_s};
  scorer.runs = closed_runs(aperture.values, scorer.scale.theta);
  const std::vector<ClosureEvent> events = closure_events(labels);
  ClosureScore score;
  for (const ClosureEvent& event : events)
    if (!event.doubtful) scorer.score_target(event, score);
  if (labels.rows.empty()) return score;
  for (const FrameRun& run : scorer.runs) scorer.score_run(run, events, score);
  return score;
}

}  // namespace mien
