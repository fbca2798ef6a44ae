#include <cmath>
#include <limits>
#include <numeric>

#include "mien/metrics/statistics.h"
#include "mien/metrics/synthetic_benchmark.h"

namespace mien {
namespace {

double generated_to_true(const Compared<MeanOf>& pair) { return pair.generated.value() / pair.truth.value(); }

struct RankSummary {
  double chi_squared, coverage_50, coverage_90;
};
// Means over the ranked curves.
RankSummary summarise(const std::array<RankHistogram, kNumRankedCurves>& ranks) {
  RankSummary out{0, 0, 0};
  for (const RankHistogram& r : ranks) {
    out.chi_squared += r.chi_squared_per_degree() / kNumRankedCurves;
    out.coverage_50 += r.coverage_50() / kNumRankedCurves;
    out.coverage_90 += r.coverage_90() / kNumRankedCurves;
  }
  return out;
}

void fill_lips(const SyntheticItemScore& sum, SyntheticFigures& f) {
  f.r = sum.lips_neutral.mean_r();
  f.r_all = sum.lips.mean_r();
  f.jaw_r = sum.lips_neutral.jaw_r();
  f.aperture_r = sum.lips_neutral.aperture.r();
  f.closure_f1 = sum.lips_neutral.closures.frame_f1();
  f.closure_f1_tolerant = sum.lips_neutral.closures.tolerant_f1();
  f.closure_hit = sum.lips_neutral.closures.hit_rate();
  f.seal = sum.lips_neutral.seal();
  f.labiodental_hit = sum.lips_neutral.labiodentals.hit_rate();
  f.timing_bias_ms = mean(sum.lips_neutral.timing_errors_ms);
  f.rounding_hit = sum.lips_neutral.rounding.hit_rate();
  f.rounding_onset_ms = median(sum.lips_neutral.rounding.onset_errors_ms);
  f.contact_f1 = sum.closures.generated.f1();
  f.contact_f1_truth = sum.closures.truth.f1();
  f.sealed = sum.closures.generated.sealed_share();
}

void fill_events(const SyntheticItemScore& sum, SyntheticFigures& f) {
  const auto& [blinks, true_blinks] = sum.blinks;
  f.blinks = blinks.per_minute(), f.blinks_truth = true_blinks.per_minute();
  f.blink_rate_ratio = f.blinks / f.blinks_truth;
  f.blink_interval_ks = ks_distance(blinks.intervals_s, true_blinks.intervals_s);
  f.blink_pause_share = blinks.share_in_pauses(), f.blink_pause_share_truth = true_blinks.share_in_pauses();
  f.blink_closing_ms = 1000 * median(blinks.closings_s),
  f.blink_closing_ms_truth = 1000 * median(true_blinks.closings_s);
  f.blink_opening_ms = 1000 * median(blinks.openings_s),
  f.blink_opening_ms_truth = 1000 * median(true_blinks.openings_s);
  f.brow_lift = sum.brows.generated.lift(), f.brow_lift_truth = sum.brows.truth.lift();
  f.brow_lift_ratio = f.brow_lift / f.brow_lift_truth;
  f.nod_lift = sum.nods.generated.lift(), f.nod_lift_truth = sum.nods.truth.lift();
  f.gaze_away = sum.gaze.generated.share_away(), f.gaze_away_truth = sum.gaze.truth.share_away();
  f.gaze_contact_s = median(sum.gaze.generated.contact_s),
  f.gaze_contact_s_truth = median(sum.gaze.truth.contact_s);
}

void fill_conditions(const SyntheticItemScore& sum, SyntheticFigures& f) {
  f.emotion = sum.emotion.generated.accuracy(), f.emotion_ceiling = sum.emotion.truth.accuracy();
  f.emotion_ratio = f.emotion / f.emotion_ceiling;
  f.level = sum.level.generated.accuracy(), f.level_ceiling = sum.level.truth.accuracy();
  f.style = sum.style.generated.accuracy(), f.style_ceiling = sum.style.truth.accuracy();
  f.pause_motion_ratio = sum.rest.generated.pause_motion_ratio();
  f.pause_motion_ratio_truth = sum.rest.truth.pause_motion_ratio();
  f.mean_pause_aperture = sum.rest.generated.mean_pause_aperture();
  f.closed_at_end = sum.rest.generated.closed_at_end_share();
}

SyntheticFigures figures_of(const SyntheticItemScore& sum, double items) {
  SyntheticFigures f;
  f.items = items;
  f.minutes = static_cast<double>(sum.diversity[0].truth.count) / kMetricFps / 60;
  fill_lips(sum, f);
  for (std::size_t r = 0; r < kNumFaceRegions; ++r) {
    f.diversity[r] = generated_to_true(sum.diversity[r]);
    f.jitter[r] = generated_to_true(sum.smoothness[r]);
    f.excess_mae[r] = sum.accuracy[r].excess_mae();
    f.spread_skill[r] = sum.calibration.regions[r].spread_skill();
    f.energy_regret[r] = sum.calibration.regions[r].energy_regret();
    f.crps_regret[r] = sum.calibration.regions[r].crps_regret();
  }
  const RankSummary ranks = summarise(sum.calibration.ranks);
  f.rank_chi_squared = ranks.chi_squared, f.coverage_50 = ranks.coverage_50,
  f.coverage_90 = ranks.coverage_90;
  fill_events(sum, f);
  fill_conditions(sum, f);
  return f;
}

using Field = SyntheticFigureField;
using Figures = SyntheticFigures;

void add(std::vector<Field>& fields, double Figures::*value, std::string name, std::string unit,
         std::string definition, std::string target = "") {
  fields.push_back({std::move(name), std::move(unit), std::move(definition), std::move(target),
                    [value](const Figures& f) { return f.*value; }});
}

// One field per region.
void add(std::vector<Field>& fields, std::array<double, kNumFaceRegions> Figures::*value,
         const std::string& name, const std::string& definition,
         const std::array<std::string, kNumFaceRegions>& targets = {}) {
  for (std::size_t r = 0; r < kNumFaceRegions; ++r)
    fields.push_back({name + ", " + std::string(region_name(kFaceRegions[r])), "",
                      r == 0 ? definition : "as for lower", targets[r],
                      [value, r](const Figures& f) { return (f.*value)[r]; }});
}

std::vector<Field> make_fields() {
  std::vector<Field> f;
  add(f, &Figures::items, "items", "items", "recordings evaluated");
  add(f, &Figures::minutes, "speech", "min", "length of all recordings");
  add(f, &Figures::r, "r", "",
      "mean over 12 lip curves of Pearson's r between the mean of the generated takes and the conditional "
      "mean (mean of the "
      "true takes), over all frames of the neutral items",
      "es >= .90, ked >= .75, slt-n >= .60");
  add(f, &Figures::r_all, "r, all emotions", "", "the same over all items");
  add(f, &Figures::jaw_r, "jaw r", "", "the same for jawOpen alone, neutral items");
  add(f, &Figures::aperture_r, "aperture r", "", "the same for jawOpen - mouthClose, neutral items");
  add(f, &Figures::closure_f1, "closure F1", "",
      "frame-exact: mean mouthPress > 0.26 gain in the conditional mean, > 0.165 gain in the mean of the "
      "generated takes; "
      "gain = the style's press gain; neutral items",
      "es >= .87, ked >= .60");
  add(f, &Figures::closure_f1_tolerant, "closure F1, +-2 frames", "",
      "the same, frames count within +-2 frames");
  add(f, &Figures::closure_hit, "closure hit rate", "",
      "runs of those truth frames with a predicted frame within +-2 frames");
  add(f, &Figures::seal, "seal", "",
      "of those runs times takes: the single take has jawOpen - mouthClose < 0.04 within +-2 frames");
  add(f, &Figures::timing_bias_ms, "closure timing", "ms",
      "mean of (aperture minimum of prediction - of truth) over hit runs");
  add(f, &Figures::labiodental_hit, "labiodental hit rate", "",
      "runs of mouthRollLower > 0.4 in the truth with more than 0.2 in the prediction within +-2 frames, "
      "neutral items");
  add(f, &Figures::rounding_hit, "rounding hit rate", "",
      "runs of mouthPucker > 0.25 in the conditional mean with a predicted peak > 0.125 within +-100 ms, "
      "neutral items");
  add(f, &Figures::rounding_onset_ms, "rounding onset", "ms",
      "median of (half-height crossing of the prediction - of the truth) over those found; positive = late");
  add(f, &Figures::contact_f1, "contact F1", "",
      "closure F1 of single takes against the phone labels by the rules of the human benchmark, 50 ms, all "
      "items");
  add(f, &Figures::contact_f1_truth, "contact F1, truth", "", "the same of the true takes");
  add(f, &Figures::sealed, "contact sealed", "", "hits of that measure with aperture <= 0 / hits");
  add(f, &Figures::pause_motion_ratio, "pause motion ratio", "",
      "speed of the aperture in pauses / in phones, single takes");
  add(f, &Figures::pause_motion_ratio_truth, "pause motion ratio, truth", "", "the same of the true takes");
  add(f, &Figures::mean_pause_aperture, "mean pause aperture", "R", "mean aperture in pauses / R");
  add(f, &Figures::closed_at_end, "last frame closed", "",
      "takes whose last frame has aperture <= theta / takes", "1");
  add(f, &Figures::diversity, "D",
      "mean L1 distance over pairs of generated takes / over pairs of true takes",
      {".3 ... 1.3", ".8 ... 1.25", ".8 ... 1.25", ".8 ... 1.25"});
  add(f, &Figures::jitter, "J", "mean |second difference| of generated / of true takes",
      {".7 ... 1.3", ".7 ... 1.3", ".7 ... 1.3", ".7 ... 1.3"});
  add(f, &Figures::excess_mae, "excess MAE",
      "(mean absolute error of the mean of the takes to a held-out take - that of the conditional mean) / "
      "the latter");
  add(f, &Figures::spread_skill, "spread-skill",
      "sqrt((K + 1) / K mean variance over takes) / RMSE of their mean to a held-out take; ideal 1");
  add(f, &Figures::energy_regret, "energy score regret",
      "energy score on 0.5 s windows / that of true takes - 1; ideal 0");
  add(f, &Figures::crps_regret, "CRPS regret", "CRPS per curve and frame / that of true takes - 1; ideal 0");
  add(f, &Figures::rank_chi_squared, "rank chi-squared", "",
      "of a held-out take among the generated ones in 0.5 s means of jawOpen, mouthSmile, browInnerUp, "
      "eyeBlink, gaze x, per degree of freedom; about 1");
  add(f, &Figures::coverage_50, "coverage 50 %", "",
      "share of those means inside the central half of the takes (ideal .5 (K - 1) / (K + 1))");
  add(f, &Figures::coverage_90, "coverage 90 %", "",
      "the same for the central 90 % (ideal .9 (K - 1) / (K + 1))");
  add(f, &Figures::blink_rate_ratio, "blink rate, generated / true", "", "both lids' mean rising through 0.5",
      ".85 ... 1.15");
  add(f, &Figures::blinks, "blinks", "1/min", "generated");
  add(f, &Figures::blinks_truth, "blinks, truth", "1/min", "true takes, the same detector");
  add(f, &Figures::blink_interval_ks, "blink intervals, KS", "",
      "Kolmogorov-Smirnov distance of inter-blink intervals", "<= .15");
  add(f, &Figures::blink_pause_share, "blinks in pauses", "", "share of blinks whose onset lies in a pause");
  add(f, &Figures::blink_pause_share_truth, "blinks in pauses, truth", "", "the same of the true takes");
  add(f, &Figures::blink_closing_ms, "blink closing", "ms", "median 10 - 90 % time");
  add(f, &Figures::blink_closing_ms_truth, "blink closing, truth", "ms", "the same of the true takes");
  add(f, &Figures::blink_opening_ms, "blink opening", "ms", "median 90 - 10 % time");
  add(f, &Figures::blink_opening_ms_truth, "blink opening, truth", "ms", "the same of the true takes");
  add(f, &Figures::brow_lift, "brow-accent lift", "",
      "P(brow raise within +-150 ms of an accent) / P(at a random time)");
  add(f, &Figures::brow_lift_truth, "brow-accent lift, truth", "", "the same of the true takes");
  add(f, &Figures::brow_lift_ratio, "brow-accent lift, generated / true", "", "ratio of both", ">= .5");
  add(f, &Figures::nod_lift, "nod-accent lift", "", "the same for nods");
  add(f, &Figures::nod_lift_truth, "nod-accent lift, truth", "", "the same of the true takes");
  add(f, &Figures::gaze_away, "gaze away", "", "share of frames with gaze 3 degrees or more off the viewer");
  add(f, &Figures::gaze_away_truth, "gaze away, truth", "", "the same of the true takes");
  add(f, &Figures::gaze_contact_s, "gaze contact", "s",
      "median duration of uncut stretches within 3 degrees");
  add(f, &Figures::gaze_contact_s_truth, "gaze contact, truth", "s", "the same of the true takes");
  add(f, &Figures::emotion, "emotion accuracy", "",
      "nearest centroid (mean and sd of 52 curves) trained on true takes of the same sentences in all "
      "emotions, on generated takes");
  add(f, &Figures::emotion_ceiling, "emotion accuracy, ceiling", "", "the same on other true takes");
  add(f, &Figures::emotion_ratio, "emotion accuracy / ceiling", "", "ratio of both", ">= .95");
  add(f, &Figures::level, "level accuracy", "", "three levels of the known emotion, emotional items");
  add(f, &Figures::level_ceiling, "level accuracy, ceiling", "", "the same on other true takes");
  add(f, &Figures::style, "style accuracy", "", "16 styles, neutral items");
  add(f, &Figures::style_ceiling, "style accuracy, ceiling", "", "the same on other true takes");
  return f;
}

}  // namespace

const std::vector<SyntheticFigureField>& synthetic_figure_fields() {
  static const std::vector<SyntheticFigureField> fields = make_fields();
  return fields;
}

SyntheticFigures pool_synthetic(std::span<const SyntheticItemScore> items,
                                std::span<const std::size_t> indices) {
  SyntheticItemScore sum;
  for (const std::size_t i : indices) sum += items[i];
  return figures_of(sum, static_cast<double>(indices.size()));
}

SyntheticFigures pool_synthetic(std::span<const SyntheticItemScore> items) {
  std::vector<std::size_t> all(items.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return pool_synthetic(items, all);
}

std::vector<Interval> synthetic_intervals(std::span<const SyntheticItemScore> items, int num_draws,
                                          std::uint64_t seed) {
  std::vector<std::string> ids;
  for (const SyntheticItemScore& item : items) ids.push_back(item.id);  // every item is its own group
  const auto& fields = synthetic_figure_fields();
  std::vector<std::vector<double>> values(fields.size());
  for (const auto& draw : speaker_draws(ids, num_draws, seed)) {
    const SyntheticFigures figures = pool_synthetic(items, draw);
    for (std::size_t f = 0; f < fields.size(); ++f) values[f].push_back(fields[f].value(figures));
  }
  std::vector<Interval> out;
  for (auto& v : values) out.push_back(interval_of(std::move(v)));
  return out;
}

}  // namespace mien
