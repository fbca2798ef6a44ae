#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/corpus/corpus_reader.h"
#include "mien/metrics/bootstrap.h"
#include "mien/metrics/closures.h"
#include "mien/metrics/condition_fidelity.h"
#include "mien/metrics/contact.h"
#include "mien/metrics/distribution.h"
#include "mien/metrics/face_events.h"
#include "mien/metrics/lip_accuracy.h"
#include "mien/metrics/report.h"

namespace mien {

/// A pair of the same measure, of the generated and of the true takes.
template <class T>
struct Compared {
  T generated{}, truth{};

  Compared& operator+=(const Compared& other) {
    generated += other.generated;
    truth += other.truth;
    return *this;
  }
};

/// What one system did on one item of a corpus; pools with +=.
struct SyntheticItemScore {
  std::string id;
  LipAccuracy lips_neutral;                                             ///< neutral items only, with closures
  LipAccuracy lips;                                                     ///< all items, correlations only
  std::array<Compared<MeanOf>, kNumFaceRegions> diversity, smoothness;  ///< in the order of kFaceRegions
  std::array<AccuracyScore, kNumFaceRegions> accuracy;
  CalibrationScore calibration;
  Compared<BlinkScore> blinks;
  Compared<AccentScore> brows, nods;
  Compared<GazeScore> gaze;
  Compared<RestScore> rest;
  Compared<ClosureScore> closures;  ///< single takes by the rules of the human benchmark, 50 ms
  Compared<FidelityCounts> emotion, level, style;  ///< truth: the ceiling

  SyntheticItemScore& operator+=(const SyntheticItemScore& other);
};

/// Figures of a pool of items; NaN where not defined.
struct SyntheticFigures {
  double items = 0, minutes = 0;
  double r = 0, r_all = 0, jaw_r = 0, aperture_r = 0;
  double closure_f1 = 0, closure_f1_tolerant = 0, closure_hit = 0, seal = 0, labiodental_hit = 0,
         timing_bias_ms = 0;
  double rounding_hit = 0, rounding_onset_ms = 0;
  double contact_f1 = 0, contact_f1_truth = 0, sealed = 0;
  std::array<double, kNumFaceRegions> diversity{}, jitter{}, excess_mae{}, spread_skill{}, energy_regret{},
      crps_regret{};
  double blink_rate_ratio = 0, blinks = 0, blinks_truth = 0, blink_interval_ks = 0;
  double blink_pause_share = 0, blink_pause_share_truth = 0;
  double blink_closing_ms = 0, blink_closing_ms_truth = 0, blink_opening_ms = 0, blink_opening_ms_truth = 0;
  double brow_lift = 0, brow_lift_truth = 0, brow_lift_ratio = 0, nod_lift = 0, nod_lift_truth = 0;
  double gaze_away = 0, gaze_away_truth = 0, gaze_contact_s = 0, gaze_contact_s_truth = 0;
  double rank_chi_squared = 0, coverage_50 = 0, coverage_90 = 0;
  double emotion = 0, emotion_ceiling = 0, emotion_ratio = 0, level = 0, level_ceiling = 0, style = 0,
         style_ceiling = 0;
  double pause_motion_ratio = 0, pause_motion_ratio_truth = 0, mean_pause_aperture = 0, closed_at_end = 0;
};
/// Name, unit, definition and target of every figure, for tables.
struct SyntheticFigureField {
  std::string name, unit, definition, target;
  std::function<double(const SyntheticFigures&)> value;
};
const std::vector<SyntheticFigureField>& synthetic_figure_fields();

SyntheticFigures pool_synthetic(std::span<const SyntheticItemScore> items,
                                std::span<const std::size_t> indices);
SyntheticFigures pool_synthetic(std::span<const SyntheticItemScore> items);
/// 95 % intervals by bootstrap over items, one per field.
std::vector<Interval> synthetic_intervals(std::span<const SyntheticItemScore> items, int num_draws,
                                          std::uint64_t seed);

/// One item for a system to animate.
struct SyntheticRequest {
  const CorpusItem& item;
  std::filesystem::path audio;  ///< 16 kHz wav
  std::span<const std::uint64_t> take_seeds;
};
/// One performance (55 channels, 60 frames/s) per seed, in the item's style, emotion and level. A length that
/// differs from the item's by up to 6 frames is cut or held to it.
using SyntheticSystem = std::function<Result<std::vector<Motion>>(const SyntheticRequest&)>;

/// What was compared on one item, for who wants to keep it.
struct SyntheticPerformances {
  const CorpusItem& item;
  std::filesystem::path audio;
  std::span<const Motion> generated;  ///< with the length of the truth
  const Motion& truth;                ///< one take that no figure's mean was made from
};

struct SyntheticOptions {
  int samples = 8;  ///< K generated takes an item, at least 2
  int true_takes =
      32;  ///< M takes for the conditional mean and the true distribution, at least K; one more is held out
  std::uint64_t seed = 1;           ///< of the generated takes
  int threads = 1;                  ///< for drawing true takes; the result does not depend on it
  std::vector<std::string> splits;  ///< use items of these splits; all when empty
  std::int64_t max_items = 0;       ///< evenly spread over the corpus; 0 = all
  /// Called for every item in their order; none: nothing is kept. Its error ends the evaluation.
  std::function<Status(const SyntheticPerformances&)> keep{};
};

struct SyntheticReport {
  SyntheticOptions options;
  std::vector<SyntheticItemScore> items;
};

/// Runs a system over a stored corpus (specification, sections 12 and 13). True takes are drawn again from
/// the phones. Errors: of the corpus files and the system, within the item's name; a corpus of another
/// generator version, an unknown speaker, a motion of the wrong shape (Errc::incompatible) or with a value
/// that is not finite; no item left; cancelled.
Result<SyntheticReport> evaluate_synthetic(const std::filesystem::path& corpus, const SyntheticSystem& system,
                                           const SyntheticOptions& options, Progress& progress);

/// Several sets side by side.
struct NamedSyntheticReport {
  std::string name;  ///< of the set: "es", "ked", ...
  SyntheticReport report;
};
MetricTable synthetic_table(std::span<const NamedSyntheticReport> sets, int num_draws = kDefaultDraws,
                            std::uint64_t seed = 1);

}  // namespace mien
