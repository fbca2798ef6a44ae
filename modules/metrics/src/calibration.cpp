#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/base/random.h"
#include "mien/core/arkit.h"
#include "mien/metrics/distribution.h"
#include "mien/metrics/statistics.h"
#include "undefined.h"

namespace mien {
namespace {

// One window of one region, frame-major.
std::vector<double> window_vector(const Motion& motion, std::int64_t first,
                                  std::span<const std::size_t> channels) {
  std::vector<double> out;
  for (std::int64_t n = first; n < first + kWindowFrames; ++n)
    for (const std::size_t c : channels) out.push_back(motion.frame(n)[c]);
  return out;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

double energy_score(const std::vector<std::vector<double>>& samples, const std::vector<double>& y) {
  const auto k = static_cast<double>(samples.size());
  double to_truth = 0, between = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    to_truth += distance(samples[i], y);
    for (std::size_t j = i + 1; j < samples.size(); ++j) between += distance(samples[i], samples[j]);
  }
  return to_truth / k -
         between / (k * (k - 1));  // half of the mean over ordered pairs = sum over i < j / (k (k - 1))
}

// Fair CRPS in one dimension; `samples` is used up.
double crps(std::vector<double>& samples, double y) {
  std::sort(samples.begin(), samples.end());
  const auto k = static_cast<double>(samples.size());
  double to_truth = 0, between = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    to_truth += std::abs(samples[i] - y);
    between +=
        samples[i] * (2.0 * static_cast<double>(i) + 1 - k);  // sum over i < j of x_j - x_i in sorted order
  }
  return to_truth / k - between / (k * (k - 1));
}

RegionCalibration calibrate(std::span<const Motion> samples, const Motion& y,
                            std::span<const Motion> stand_ins, FaceRegion region) {
  RegionCalibration out;
  out.num_samples = static_cast<std::int64_t>(samples.size());
  const auto channels = region_channels(region);
  const auto k = static_cast<double>(samples.size());
  std::vector<double> column(samples.size()), true_column(samples.size());
  for (std::int64_t n = 0; n < y.num_frames(); ++n) {
    for (const std::size_t c : channels) {
      const double truth = y.frame(n)[c];
      double sum = 0, squares = 0;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        column[i] = samples[i].frame(n)[c];
        true_column[i] = stand_ins[i].frame(n)[c];
        sum += column[i];
      }
      const double centre = sum / k;
      for (const double x : column) squares += (x - centre) * (x - centre);
      out.variance.add(squares / (k - 1));
      out.squared_error.add((centre - truth) * (centre - truth));
      out.crps.add(crps(column, truth));
      out.crps_floor.add(crps(true_column, truth));
    }
  }
  for (std::int64_t first = 0; first + kWindowFrames <= y.num_frames(); first += kWindowFrames) {
    std::vector<std::vector<double>> generated, truths;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      generated.push_back(window_vector(samples[i], first, channels));
      truths.push_back(window_vector(stand_ins[i], first, channels));
    }
    const std::vector<double> truth = window_vector(y, first, channels);
    out.energy.add(energy_score(generated, truth));
    out.energy_floor.add(energy_score(truths, truth));
  }
  return out;
}

// Mean of a ranked curve over a window.
double ranked_mean(const Motion& motion, std::size_t curve, std::int64_t first) {
  static const std::size_t jaw = arkit_index("jawOpen"), smile_l = arkit_index("mouthSmileLeft"),
                           smile_r = arkit_index("mouthSmileRight"), brow = arkit_index("browInnerUp"),
                           blink_l = arkit_index("eyeBlinkLeft"), blink_r = arkit_index("eyeBlinkRight"),
                           out_l = arkit_index("eyeLookOutLeft"), in_l = arkit_index("eyeLookInLeft"),
                           out_r = arkit_index("eyeLookOutRight"), in_r = arkit_index("eyeLookInRight");
  double sum = 0;
  for (std::int64_t n = first; n < first + kWindowFrames; ++n) {
    const auto f = motion.frame(n);
    switch (curve) {
      case 0:
        sum += f[jaw];
        break;
      case 1:
        sum += 0.5 * (f[smile_l] + f[smile_r]);
        break;
      case 2:
        sum += f[brow];
        break;
      case 3:
        sum += 0.5 * (f[blink_l] + f[blink_r]);
        break;
      default:
        sum += 0.5 * ((f[out_l] + f[in_r]) - (f[in_l] + f[out_r]));
        break;
    }
  }
  return sum / static_cast<double>(kWindowFrames);
}

RankHistogram rank_windows(std::span<const Motion> samples, const Motion& y, std::size_t curve) {
  RankHistogram out;
  out.counts.assign(samples.size() + 1, 0);
  Rng ties(curve);  // equal values get a rank at random, the same on every run
  for (std::int64_t first = 0; first + kWindowFrames <= y.num_frames(); first += kWindowFrames) {
    const double truth = ranked_mean(y, curve, first);
    std::vector<double> values;
    std::uint64_t below = 0, equal = 0;
    for (const Motion& sample : samples) {
      values.push_back(ranked_mean(sample, curve, first));
      below += values.back() < truth;
      equal += values.back() == truth;
    }
    ++out.counts[below + ties.below(equal + 1)];
    ++out.windows;
    out.inside_50 += truth >= percentile(values, 25) && truth <= percentile(values, 75);
    out.inside_90 += truth >= percentile(values, 5) && truth <= percentile(values, 95);
  }
  return out;
}

double share(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : kNan;
}

}  // namespace

std::span<const std::string_view, kNumRankedCurves> ranked_curve_names() {
  static constexpr std::string_view kNames[kNumRankedCurves] = {"jawOpen", "mouthSmile", "browInnerUp",
                                                                "eyeBlink", "gaze x"};
  return kNames;
}

RegionCalibration& RegionCalibration::operator+=(const RegionCalibration& other) {
  variance += other.variance;
  squared_error += other.squared_error;
  energy += other.energy;
  energy_floor += other.energy_floor;
  crps += other.crps;
  crps_floor += other.crps_floor;
  contract(num_samples == 0 || other.num_samples == 0 || num_samples == other.num_samples,
           "RegionCalibration: pooled scores need the same number of samples");
  num_samples = std::max(num_samples, other.num_samples);
  return *this;
}

double RegionCalibration::spread_skill() const {
  if (num_samples == 0) return kNan;
  const auto k = static_cast<double>(num_samples);
  return std::sqrt((k + 1) / k * variance.value()) / std::sqrt(squared_error.value());
}

RankHistogram& RankHistogram::operator+=(const RankHistogram& other) {
  if (counts.empty()) counts.assign(other.counts.size(), 0);
  contract(other.counts.empty() || counts.size() == other.counts.size(),
           "RankHistogram: pooled histograms need the same number of samples");
  for (std::size_t i = 0; i < other.counts.size(); ++i) counts[i] += other.counts[i];
  inside_50 += other.inside_50;
  inside_90 += other.inside_90;
  windows += other.windows;
  return *this;
}

double RankHistogram::chi_squared_per_degree() const {
  if (windows == 0 || counts.size() < 2) return kNan;
  const double expected = static_cast<double>(windows) / static_cast<double>(counts.size());
  double sum = 0;
  for (const std::int64_t count : counts) {
    const double difference = static_cast<double>(count) - expected;
    sum += difference * difference / expected;
  }
  return sum / static_cast<double>(counts.size() - 1);
}

double RankHistogram::coverage_50() const { return share(inside_50, windows); }
double RankHistogram::coverage_90() const { return share(inside_90, windows); }

CalibrationScore& CalibrationScore::operator+=(const CalibrationScore& other) {
  for (std::size_t r = 0; r < regions.size(); ++r) regions[r] += other.regions[r];
  for (std::size_t c = 0; c < ranks.size(); ++c) ranks[c] += other.ranks[c];
  return *this;
}

CalibrationScore score_calibration(std::span<const Motion> samples, const Motion& held_out,
                                   std::span<const Motion> true_takes) {
  contract(samples.size() >= 2 && true_takes.size() >= samples.size(),
           "score_calibration: at least two samples and as many true takes are needed");
  require_performance(held_out);
  const std::span<const Motion> stand_ins = true_takes.first(samples.size());
  for (const auto group : {samples, stand_ins}) {
    for (const Motion& motion : group) {
      require_performance(motion);
      contract(motion.values.size() == held_out.values.size(),
               "score_calibration: the motions differ in length");
    }
  }
  CalibrationScore out;
  for (std::size_t r = 0; r < kNumFaceRegions; ++r)
    out.regions[r] = calibrate(samples, held_out, stand_ins, kFaceRegions[r]);
  for (std::size_t c = 0; c < kNumRankedCurves; ++c) out.ranks[c] = rank_windows(samples, held_out, c);
  return out;
}

}  // namespace mien
