#include "mien/metrics/human_benchmark.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numeric>

#include "labels_for_tests.h"
#include "mien/audio/load_audio.h"
#include "mien/base/hash.h"
#include "mien/corpus/take.h"
#include "mien/metrics/baselines.h"
#include "mien/metrics/human_report.h"
#include "mien/metrics/loudness.h"
#include "mien/metrics/utterance_labels.h"
#include "test_paths.h"

namespace mien {
namespace {

using test::make_labels;
using test::open_except;

std::filesystem::path human_folder() { return shared_path("audio/human"); }

// The rows of the README's last table, in its order.
enum Predictor { oracle, late_60, late_100, loud, steep, shut, random_times, num_predictors };

std::vector<std::vector<HumanClipScore>> reference_scores() {
  std::vector<std::vector<HumanClipScore>> scores(num_predictors);
  const auto clips = read_benchmark(human_folder());
  EXPECT_TRUE(clips) << clips.error().message();
  for (const BenchmarkClip& clip : *clips) {
    if (!belongs_to(clip, SpeechGroup::english_clean)) continue;
    const auto labels = read_labels(clip);
    EXPECT_TRUE(labels) << labels.error().message();
    const auto audio = load_audio(clip.audio);
    EXPECT_TRUE(audio) << audio.error().message();
    const auto e = loudness(speech_level_db(audio->samples));
    const Aperture apertures[] = {oracle_aperture(e, *labels, 0),     oracle_aperture(e, *labels, 0.060),
                                  oracle_aperture(e, *labels, 0.100), loudness_aperture(e),
                                  steep_loudness_aperture(e),         shut_aperture(e.size())};
    for (std::size_t p = 0; p < random_times; ++p)
      scores[p].push_back(score_human_clip(clip, *labels, apertures[p], {}, {}, nullptr));
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      const Aperture chance = random_aperture(e, *labels, hash_combine(hash64(clip.id), seed));
      scores[random_times].push_back(score_human_clip(clip, *labels, chance, {}, {}, nullptr));
    }
  }
  return scores;
}

// The definitions are proved by the digits that the README prints: values within rounding, intervals (other
// draws than the README's) within 0.03.
TEST(HumanBenchmark, ReproducesTheReferenceTable) {
  if (!std::filesystem::exists(human_folder() / "manifest.json"))
    GTEST_SKIP() << human_folder() << " is absent";
  const auto scores = reference_scores();
  struct Row {
    Predictor predictor;
    double hit, precision, f1, timing, mad;
  };
  constexpr double kNone = -1000;
  for (const Row& want : {Row{oracle, 1.00, 1.00, 1.00, 0, 3}, Row{late_60, 1.00, 1.00, 1.00, 60, 2},
                          Row{late_100, .79, .80, .80, 100, 3}, Row{loud, .34, .34, .34, 0, 8},
                          Row{steep, .67, .30, .41, 2, 18}, Row{shut, .00, .05, .00, kNone, kNone}}) {
    SCOPED_TRACE(testing::Message() << "row " << want.predictor);
    const HumanFigures got = pool_human(scores[want.predictor]);
    EXPECT_EQ(got.targets, 262);
    EXPECT_NEAR(got.hit_rate, want.hit, 0.005);
    EXPECT_NEAR(got.precision, want.precision, 0.005);
    EXPECT_NEAR(got.f1, want.f1, 0.005);
    if (want.timing == kNone) {
      EXPECT_EQ(got.timed_hits, 0);
      continue;
    }
    EXPECT_NEAR(got.timing_bias_ms, want.timing, 0.5 + 1e-9);
    EXPECT_NEAR(got.timing_mad_ms, want.mad, 0.5 + 1e-9);
  }
  // The README prints one draw of closure times; one draw has a standard deviation of .02 to .03, and eight
  // are pooled here.
  const HumanFigures chance = pool_human(scores[random_times]);
  EXPECT_NEAR(chance.hit_rate, .18, 0.06);
  EXPECT_NEAR(chance.precision, .23, 0.06);
  EXPECT_NEAR(chance.f1, .20, 0.06);

  const auto interval = [&](Predictor predictor, double HumanFigures::*value) {
    const auto all = human_intervals(scores[predictor], 1000, 1);
    const auto fields = human_figure_fields();
    for (std::size_t f = 0; f < fields.size(); ++f)
      if (fields[f].value == value) return all[f];
    return Interval{};
  };
  const auto expect_interval = [](Interval got, double low, double high) {
    EXPECT_NEAR(got.low, low, 0.03);
    EXPECT_NEAR(got.high, high, 0.03);
  };
  expect_interval(interval(late_60, &HumanFigures::hit_rate), .98, 1.00);
  expect_interval(interval(late_100, &HumanFigures::f1), .72, .88);
  expect_interval(interval(loud, &HumanFigures::hit_rate), .20, .45);
  expect_interval(interval(loud, &HumanFigures::precision), .28, .44);
  expect_interval(interval(loud, &HumanFigures::f1), .24, .40);
  expect_interval(interval(steep, &HumanFigures::hit_rate), .54, .78);
  expect_interval(interval(steep, &HumanFigures::precision), .25, .35);
  expect_interval(interval(steep, &HumanFigures::f1), .36, .47);
}

TEST(HumanBenchmark, TheSetIsAsItsReadmeSays) {
  if (!std::filesystem::exists(human_folder() / "manifest.json"))
    GTEST_SKIP() << human_folder() << " is absent";
  const auto clips = read_benchmark(human_folder());
  ASSERT_TRUE(clips) << clips.error().message();
  EXPECT_EQ(clips->size(), 81u);
  int targets = 0, doubtful = 0;
  std::int64_t counts[4] = {};
  for (const BenchmarkClip& clip : *clips) {
    const auto labels = read_labels(clip);
    ASSERT_TRUE(labels) << labels.error().message();
    EXPECT_NEAR(labels->seconds(), clip.seconds, 0.002) << clip.id;
    for (const ClosureEvent& event : closure_events(*labels)) (event.doubtful ? doubtful : targets)++;
    for (std::size_t g = 0; g < 4; ++g) counts[g] += belongs_to(clip, kSpeechGroups[g]);
    if (clip.style == "noisy") {
      EXPECT_NE(clip.clean_id, clip.id);
    }
  }
  EXPECT_EQ(targets, 309);
  EXPECT_EQ(doubtful, 11);
  EXPECT_EQ(counts[0], 65);
  EXPECT_EQ(counts[1], 6);
  EXPECT_EQ(counts[2], 10);
  EXPECT_EQ(counts[3], 11);
}

// What a perfect recogniser of phones in front of the corpus generator would reach: the ceiling of systems
// trained on it.
TEST(HumanBenchmark, TheCurveGeneratorOnTrueLabelsIsNearTheTop) {
  if (!std::filesystem::exists(human_folder() / "manifest.json"))
    GTEST_SKIP() << human_folder() << " is absent";
  const auto clips = read_benchmark(human_folder());
  ASSERT_TRUE(clips);
  HumanEvaluation evaluation;
  evaluation.load = load_audio;
  evaluation.generate = [&](std::string_view id, std::span<const float>) -> Result<std::vector<Motion>> {
    const auto clip = std::find_if(clips->begin(), clips->end(), [&](const auto& c) { return c.id == id; });
    MIEN_TRY(const SpeechLabels labels, read_labels(*clip));
    return std::vector<Motion>{default_performance(utterance_of(labels))};
  };
  Progress progress;
  const auto report = evaluate_human(human_folder(), evaluation, progress);
  ASSERT_TRUE(report) << report.error().message();
  std::vector<HumanClipScore> english;
  for (const std::size_t i : report->group(SpeechGroup::english_clean)) english.push_back(report->scores[i]);
  const HumanFigures f = pool_human(english);
  EXPECT_GT(f.hit_rate, 0.98);
  EXPECT_GT(f.f1, 0.88);
  EXPECT_GT(f.sealed_share, 0.98);
  EXPECT_LT(std::abs(f.timing_bias_ms), 15);
  EXPECT_LT(f.pause_motion_ratio, 0.05);
  EXPECT_LT(f.mean_pause_aperture, 0.02);
  EXPECT_GT(f.jaw_energy_r, 0.4);
}

HumanClipScore clip_score(const std::string& id, const std::string& speaker, const Aperture& aperture) {
  BenchmarkClip clip;
  clip.id = id, clip.speaker = speaker;
  const SpeechLabels labels = make_labels({{"sil", 0.5}, {"aa", 0.5}, {"p", 0.1}, {"aa", 0.5}, {"sil", 0.5}});
  return score_human_clip(clip, labels, aperture, {}, {}, nullptr);
}

TEST(HumanBenchmark, PoolsCountsBeforeRatios) {
  const auto good = clip_score("a", "x", open_except(2.1, {{1.0, 1.1}}));
  const auto bad = clip_score("b", "y", open_except(2.1, {{0.6, 0.7}, {1.3, 1.4}}));
  const HumanFigures pooled = pool_human(std::vector<HumanClipScore>{good, bad});
  EXPECT_DOUBLE_EQ(pooled.hit_rate, 0.5);
  EXPECT_NEAR(pooled.precision, 1.0 / 3, 1e-12);
  EXPECT_NEAR(pooled.f1, 0.4, 1e-12);
  EXPECT_TRUE(std::isnan(pooled.jaw_energy_r));
}

TEST(HumanBenchmark, PairedDifferenceOfEqualSystemsIsZeroAndOfUnequalOnesIsNot) {
  std::vector<HumanClipScore> good, bad;
  for (int i = 0; i < 6; ++i) {
    const std::string id = std::to_string(i), speaker = std::to_string(i % 3);
    good.push_back(clip_score(id, speaker, open_except(2.1, {{1.0, 1.1}})));
    bad.push_back(clip_score(id, speaker,
                             open_except(2.1, i % 2 == 0 ? std::vector<std::pair<double, double>>{{1.0, 1.1}}
                                                         : std::vector<std::pair<double, double>>{})));
  }
  const auto fields = human_figure_fields();
  std::size_t f1 = 0;
  while (fields[f1].value != &HumanFigures::f1) ++f1;
  const Interval same = human_difference_intervals(good, good, 200, 3)[f1];
  EXPECT_EQ(same.low, 0);
  EXPECT_EQ(same.high, 0);
  EXPECT_GT(human_difference_intervals(good, bad, 200, 3)[f1].high, 0.1);
  bad[0].id = "other";
  EXPECT_THROW((void)human_difference_intervals(good, bad, 2, 3), std::logic_error);
}

// Runs the whole evaluation with a system that knows the labels: everything is hit, in several takes and at
// 30 fps.
TEST(HumanBenchmark, EvaluatesASystemOverTheFolder) {
  if (!std::filesystem::exists(human_folder() / "manifest.json"))
    GTEST_SKIP() << human_folder() << " is absent";
  const auto clips = read_benchmark(human_folder());
  ASSERT_TRUE(clips);
  HumanEvaluation evaluation;
  evaluation.only = {"vctk_p225_003", "vctk_p287_001_noisy"};
  evaluation.load = load_audio;
  evaluation.generate = [&](std::string_view id,
                            std::span<const float> samples) -> Result<std::vector<Motion>> {
    const auto clip = std::find_if(clips->begin(), clips->end(), [&](const auto& c) { return c.id == id; });
    const auto labels = read_labels(*clip);
    const auto aperture = oracle_aperture(loudness(speech_level_db(samples)), *labels, 0);
    Motion motion{MotionSpace::arkit, {"jawOpen", "mouthClose"}, 60, {}};
    for (const double a : aperture.values)
      motion.values.insert(motion.values.end(), {static_cast<float>(a), 0.f});
    return std::vector<Motion>{motion, resample(motion, 30)};
  };
  Progress progress;
  const auto report = evaluate_human(human_folder(), evaluation, progress);
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->takes, 2);
  EXPECT_EQ(report->group(SpeechGroup::noisy), std::vector<std::size_t>{1});
  const HumanFigures figures = pool_human(report->scores);
  EXPECT_GT(figures.hit_rate, 0.99);
  EXPECT_GT(figures.jaw_energy_r, 0.5);
  EXPECT_EQ(report->scores[0].jaw.size(), 2u);
  EXPECT_LT(pool_human(report->loudness).f1, 0.9);

  const MetricTable table = human_table(*report, 50);
  ASSERT_EQ(table.columns.size(), 3u);  // English clean, noisy, loudness only
  EXPECT_EQ(table.columns.back(), "loudness only, English clean");
  EXPECT_TRUE(table.rows[1].cells[0].interval);
  EXPECT_NE(to_markdown(table).find("fewer than 30"), std::string::npos);

  evaluation.only = {"nobody"};
  EXPECT_FALSE(evaluate_human(human_folder(), evaluation, progress));
  evaluation.only = {"vctk_p225_003"};
  evaluation.generate = [](std::string_view, std::span<const float>) -> Result<std::vector<Motion>> {
    return std::vector<Motion>{
        {MotionSpace::arkit, {"jawOpen", "mouthClose"}, 60, std::vector<float>(20, 0.f)}};
  };
  const auto cut = evaluate_human(human_folder(), evaluation, progress);
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().code, Errc::incompatible);
  EXPECT_NE(cut.error().message().find("vctk_p225_003"), std::string::npos);
  progress.cancel();
  EXPECT_EQ(evaluate_human(human_folder(), evaluation, progress).error().code, Errc::cancelled);
}

}  // namespace
}  // namespace mien
