#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/audio_clip.h"
#include "mien/core/motion.h"
#include "mien/metrics/aperture.h"
#include "mien/metrics/benchmark_set.h"
#include "mien/metrics/bootstrap.h"
#include "mien/metrics/closures.h"
#include "mien/metrics/contact.h"
#include "mien/metrics/jaw_energy.h"

namespace mien {

/// What one system did on one recording, over all of its takes.
struct HumanClipScore {
  std::string id;
  std::string speaker;
  ClosureScore closures;  ///< tolerance 50 ms
  ClosureScore strict;    ///< tolerance 20 ms
  RestScore rest;
  std::vector<JawEnergy> jaw;  ///< one a take
};

/// Scores one take from its aperture. @param jaw, level_db, mouth  as in jaw_energy() and score_rest(); an
/// empty jaw or level leaves the jaw-energy correlation out.
HumanClipScore score_human_clip(const BenchmarkClip& clip, const SpeechLabels& labels,
                                const Aperture& aperture, std::span<const double> jaw,
                                std::span<const double> level_db, const Motion* mouth);

/// Figures of a pool of recordings; NaN where not defined.
struct HumanFigures {
  double targets = 0, hit_rate = 0, precision = 0, f1 = 0, sealed_share = 0;
  double timing_bias_ms = 0, timing_mad_ms = 0, timed_hits = 0, depth = 0;
  double strict_hit_rate = 0, strict_precision = 0, strict_f1 = 0;
  double pause_motion_ratio = 0, mouth_pause_motion_ratio = 0, curve_pause_motion_ratio = 0;
  double mean_pause_aperture = 0, closed_at_end_share = 0;
  double jaw_energy_r = 0, jaw_energy_lag_ms = 0;
};
/// Name, unit and definition of every figure, for tables.
struct HumanFigureField {
  std::string_view name, unit, definition;
  double HumanFigures::*value;
};
std::span<const HumanFigureField> human_figure_fields();

/// Counts and sums are added over the recordings, then ratios formed. An index may repeat (bootstrap).
HumanFigures pool_human(std::span<const HumanClipScore> clips, std::span<const std::size_t> indices);
HumanFigures pool_human(std::span<const HumanClipScore> clips);

/// 95 % intervals over speakers, one per field of human_figure_fields().
std::vector<Interval> human_intervals(std::span<const HumanClipScore> clips, int num_draws,
                                      std::uint64_t seed);
/// Intervals of figures(a) - figures(b) with the same draws for both. @pre a and b hold the same recordings
/// in order
std::vector<Interval> human_difference_intervals(std::span<const HumanClipScore> a,
                                                 std::span<const HumanClipScore> b, int num_draws,
                                                 std::uint64_t seed);

/// How to evaluate a system on the benchmark.
struct HumanEvaluation {
  ApertureVariant variant = ApertureVariant::curves;  ///< curves or press; mesh systems use score_human_clip
  /// Reads a recording as mono 16 kHz (load_audio of room audio).
  std::function<Result<AudioClip>(const std::filesystem::path&)> load;
  /// Takes of one recording: one or more motions with ARKit channels, any frame rate.
  std::function<Result<std::vector<Motion>>(std::string_view clip_id, std::span<const float> samples_16k)>
      generate;
  /// Recordings to use; all when empty.
  std::vector<std::string> only;
};

/// Result of an evaluation, clip by clip, beside the loudness-only baseline on the same clips.
struct HumanReport {
  ApertureVariant variant = ApertureVariant::curves;
  double motion_fps = 0;   ///< of the predictions, before they were brought to 60
  std::int64_t takes = 0;  ///< per recording
  std::vector<BenchmarkClip> clips;
  std::vector<HumanClipScore> scores;    ///< [clips]
  std::vector<HumanClipScore> loudness;  ///< [clips] steep_loudness_aperture(), closures only

  /// Positions of the clips of a group.
  [[nodiscard]] std::vector<std::size_t> group(SpeechGroup group) const;
};

/// Runs a system over the benchmark in `folder`. Evaluation only: nothing may be fitted to these recordings.
/// Errors: of the manifest, labels, loader and generator, within the clip's name; a motion that is not
/// finite, lacks jawOpen or mouthClose, or ends more than 0.1 s before its recording (Errc::incompatible);
/// cancelled.
Result<HumanReport> evaluate_human(const std::filesystem::path& folder, const HumanEvaluation& evaluation,
                                   Progress& progress);

}  // namespace mien
