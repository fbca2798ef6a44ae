#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "mien/core/motion.h"
#include "mien/metrics/mean_of.h"
#include "mien/metrics/regions.h"

namespace mien {

/// Whether samples are distributed like the truth: spread, smoothness, calibration (corpus specification,
/// section 13). All motions are performances (require_performance) of one recording and equally long.
/// Everything pools over recordings with +=.

/// Mean L1 distance over all pairs of takes, per channel and frame; recordings count by their frames.
/// Its ratio generated / true is D: 1 is right, 0 = deterministic, > 1 = noise. Empty for fewer than two
/// takes.
MeanOf pair_distance(std::span<const Motion> takes, FaceRegion region);

/// Mean |x[n+1] - 2 x[n] + x[n-1]| over channels, inner frames and takes. Its ratio generated / true is J:
/// above 1.3 is jitter, below 0.7 is over-smoothing.
MeanOf second_difference(std::span<const Motion> takes, FaceRegion region);

/// Error of a prediction to a held-out take, beside that of the conditional mean (the floor).
struct AccuracyScore {
  MeanOf absolute, squared, floor_absolute, floor_squared;

  AccuracyScore& operator+=(const AccuracyScore& other);
  /// (error - floor) / floor of the mean absolute error.
  [[nodiscard]] double excess_mae() const;
  /// The same of the root mean square error.
  [[nodiscard]] double excess_rmse() const;
};
AccuracyScore score_accuracy(const Motion& prediction, const Motion& conditional_mean, const Motion& held_out,
                             FaceRegion region);

/// Length of the windows of the energy score and of the rank histograms: half a second.
inline constexpr std::int64_t kWindowFrames = 30;
/// Curves whose windowed means are ranked: jawOpen, mouthSmile and browInnerUp, eyeBlink, horizontal gaze;
/// sides averaged.
inline constexpr std::size_t kNumRankedCurves = 5;
std::span<const std::string_view, kNumRankedCurves> ranked_curve_names();

/// Calibration of K samples of one region against a held-out take y.
struct RegionCalibration {
  MeanOf variance;              ///< over samples, unbiased
  MeanOf squared_error;         ///< of the sample mean to y
  MeanOf energy, energy_floor;  ///< energy score of the samples, and of as many true takes in their place
  MeanOf crps, crps_floor;
  std::int64_t num_samples = 0;  ///< K

  RegionCalibration& operator+=(const RegionCalibration& other);
  /// sqrt((K + 1) / K mean variance) / RMSE of the sample mean to y; ideal 1, below 1 = too sure.
  [[nodiscard]] double spread_skill() const;
  /// Energy score minus its floor, as a share of the floor; at least 0 up to sampling error.
  [[nodiscard]] double energy_regret() const { return energy.value() / energy_floor.value() - 1; }
  [[nodiscard]] double crps_regret() const { return crps.value() / crps_floor.value() - 1; }
};

/// Ranks of y among the samples, per ranked curve.
struct RankHistogram {
  std::vector<std::int64_t> counts;  ///< [K + 1]
  std::int64_t inside_50 = 0, inside_90 = 0, windows = 0;

  RankHistogram& operator+=(const RankHistogram& other);
  /// Chi-squared against equal counts, divided by its degrees of freedom K: about 1 when calibrated.
  [[nodiscard]] double chi_squared_per_degree() const;
  /// Share of windows in which y lies in the central 50 % (90 %) of the samples; ideal is that share times
  /// (K - 1) / (K + 1), because the quantiles of K samples lie inside those of their distribution.
  [[nodiscard]] double coverage_50() const;
  [[nodiscard]] double coverage_90() const;
};

struct CalibrationScore {
  std::array<RegionCalibration, kNumFaceRegions> regions;  ///< in the order of kFaceRegions
  std::array<RankHistogram, kNumRankedCurves> ranks;

  CalibrationScore& operator+=(const CalibrationScore& other);
};

/// Energy score of a window of vectors: mean |x_i - y| - 1/2 mean over i != j of |x_i - x_j| (the fair form:
/// unbiased in K), Euclidean over the region's curves and frames of the window. CRPS: the same per curve and
/// frame in one dimension.
/// @param samples     [K] generated, K >= 2
/// @param held_out    y
/// @param true_takes  at least K takes other than y; the first K stand in for the samples in the floors
CalibrationScore score_calibration(std::span<const Motion> samples, const Motion& held_out,
                                   std::span<const Motion> true_takes);

}  // namespace mien
