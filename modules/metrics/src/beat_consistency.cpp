#include "mien/metrics/beat_consistency.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mien/base/contract.h"
#include "undefined.h"

namespace mien {
namespace {

double moved(const FeatureTable& t, std::int64_t n, std::size_t k) {
  return std::abs(t.row(n + 1)[k] - t.row(n)[k]);
}

// Mean over sequences of the mean |difference| of every channel.
std::vector<double> mean_changes(std::span<const BeatSequence> sequences) {
  std::vector<double> mean(static_cast<std::size_t>(sequences.front().coefficients.width), 0.0);
  double count = 0;
  for (const auto& s : sequences) {
    const std::int64_t num_changes = s.coefficients.num_rows() - 1;
    if (num_changes < 1) continue;
    ++count;
    for (std::size_t k = 0; k < mean.size(); ++k) {
      double sum = 0;
      for (std::int64_t n = 0; n < num_changes; ++n) sum += moved(s.coefficients, n, k);
      mean[k] += sum / static_cast<double>(num_changes);
    }
  }
  for (double& m : mean) m /= std::max(count, 1.0);
  return mean;
}

std::vector<double> kinematic_beats(const FeatureTable& t, const std::vector<double>& changes,
                                    const BeatOptions& o) {
  std::vector<double> rate, beats;
  const auto num_moving = static_cast<double>(std::ranges::count_if(changes, [](double c) { return c > 0; }));
  for (std::int64_t n = 0; n + 1 < t.num_rows(); ++n) {
    double sum = 0;
    for (std::size_t k = 0; k < changes.size(); ++k)
      if (changes[k] > 0) sum += moved(t, n, k) / changes[k];
    rate.push_back(num_moving > 0 ? sum / num_moving : 0);
  }
  for (std::size_t n = 1; n + 1 < rate.size(); ++n) {
    if (!(rate[n] < rate[n - 1] && rate[n] < rate[n + 1])) continue;
    if (rate[n - 1] - rate[n] > o.threshold || rate[n + 1] - rate[n] > o.threshold)
      beats.push_back(static_cast<double>(n) / o.fps);
  }
  return beats;
}

}  // namespace

double beat_consistency(std::span<const BeatSequence> sequences, const BeatOptions& options) {
  contract(options.fps > 0 && options.sigma > 0, "beat_consistency: rate and width must be positive");
  double sum = 0, count = 0;
  if (sequences.empty()) return kNan;
  for (const auto& s : sequences)
    contract(s.coefficients.width == sequences.front().coefficients.width,
             "beat_consistency: sequences of different channels");
  const std::vector<double> changes = mean_changes(sequences);
  for (const auto& s : sequences) {
    if (s.audio_beats.empty()) continue;
    ++count;
    const auto beats = kinematic_beats(s.coefficients, changes, options);
    if (beats.empty()) continue;
    double score = 0;
    for (const double t : s.audio_beats) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const double b : beats) nearest = std::min(nearest, std::abs(b - t));
      score += std::exp(-nearest * nearest / (2 * options.sigma * options.sigma));
    }
    sum += score / static_cast<double>(s.audio_beats.size());
  }
  return count == 0 ? kNan : sum / count;
}

}  // namespace mien
