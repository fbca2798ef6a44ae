#include "mien/corpus/gestures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mien/corpus/articulation.h"
#include "synthetic_utterance.h"

// Statistics of the processes of the corpus specification, section 7.
namespace mien {
namespace {

constexpr double kHour = 3600;

double mean_of(const std::vector<float>& v) {
  return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
}
double sd_of(const std::vector<float>& v) {
  const double mean = mean_of(v);
  double sum = 0;
  for (const float x : v) sum += (x - mean) * (x - mean);
  return std::sqrt(sum / static_cast<double>(v.size()));
}

TEST(Blinks, RateIncludesDoubles) {
  Rng rng(1);
  const auto events = draw_blinks({.blinks_per_minute = 18, .seconds = 20 * kHour}, rng);
  const double per_minute = static_cast<double>(events.size()) / (20 * 60);
  EXPECT_NEAR(per_minute, 19.2, 0.4);
  for (std::size_t i = 0; i < events.size(); ++i) {
    ASSERT_GE(events[i].onset_s, 0);
    ASSERT_LT(events[i].onset_s, 20 * kHour);
    ASSERT_GE(events[i].onset_s - (i > 0 ? events[i - 1].onset_s : -1), 0.25);
  }
}

TEST(Blinks, LidsAreShutForAFewPercentOfTheTime) {
  Rng rng(2);
  const auto events = draw_blinks({.blinks_per_minute = 18, .seconds = kHour}, rng);
  double shut = 0;
  for (const BlinkEvent& e : events)
    for (double t = 0; t < e.seconds(); t += 0.001) shut += e.amplitude * blink_shape(e, t) > 0.5 ? 0.001 : 0;
  // From the laws of section 7: 149 ms for each of 19.2 blinks a minute.
  EXPECT_NEAR(shut / kHour, 0.048, 0.004);
}

TEST(Blinks, MoveIntoPausesAndFollowLargeGazeShifts) {
  BlinkContext context{.blinks_per_minute = 18, .seconds = 5 * kHour};
  for (double t = 2; t < context.seconds; t += 2.5) context.pauses.push_back({t, t + 0.3});
  const auto share_in_pauses = [&](const std::vector<BlinkEvent>& events) {
    const auto is_in = [&](const BlinkEvent& e) {
      return std::any_of(context.pauses.begin(), context.pauses.end(),
                         [&](const TimeSpan& p) { return e.onset_s >= p.start_s && e.onset_s < p.end_s; });
    };
    return static_cast<double>(std::count_if(events.begin(), events.end(), is_in)) /
           static_cast<double>(events.size());
  };
  Rng a(3), b(3);
  const auto events = draw_blinks(context, a);
  // 12 % of the time is pause. A blink is within reach of one for 1.1 of 2.5 s; half of these move.
  EXPECT_NEAR(share_in_pauses(events), 0.12 + 0.5 * (0.44 - 0.12), 0.04);
  for (double t = 5; t < context.seconds; t += 5) context.shifts.push_back({t, t < kHour ? 7.9 : 8.1});
  const auto more = draw_blinks(context, b);
  const double added = static_cast<double>(more.size()) - static_cast<double>(events.size());
  EXPECT_NEAR(added / (0.25 * 1.06 * 4 * kHour / 5), 0.95, 0.12)
      << "some fall on a blink that is there already";
}

TEST(Blinks, NoTimeNoBlinks) {
  Rng rng(4);
  EXPECT_TRUE(draw_blinks({.blinks_per_minute = 30, .seconds = 0}, rng).empty());
}

TEST(Gaze, DwellsAndSharesAreThoseOfTheSpeaker) {
  Speaker speaker;
  Rng rng(5);
  const GazeTrack gaze = draw_gaze(speaker, static_cast<std::int64_t>(2 * kHour * 60), rng);
  std::int64_t contact = 0;
  double left = 0, up = 0, down = 0, furthest = 0;
  for (std::size_t n = 0; n < gaze.x_deg.size(); ++n) {
    const double x = gaze.x_deg[n], y = gaze.y_deg[n];
    contact += std::hypot(x, y) < 2;
    left += x > 2;
    up += y > 2;
    down += y < -2;
    furthest = std::max(furthest, std::hypot(x, y));
  }
  // Contact 2.2 s x exp(.18), away 0.9 s x exp(.125); a fifth of the looks away are shorter than 2 degrees.
  const double share = 2.634 / (2.634 + 1.02);
  EXPECT_NEAR(static_cast<double>(contact) / static_cast<double>(gaze.x_deg.size()),
              share + 0.2 * (1 - share), 0.04);
  EXPECT_GT(down, up);
  EXPECT_GT(left, 0);
  EXPECT_LT(furthest, 27 + 3);
  EXPECT_GT(furthest, 20);
  const double shifts_per_minute = static_cast<double>(gaze.shifts.size()) / 120;
  EXPECT_NEAR(shifts_per_minute, 60 * 2 / (2.634 + 1.02), 2);
  EXPECT_NEAR(mean_of(gaze.x_deg), 0, 0.3);

  speaker.gaze_away = 0.55;
  Rng same(5);
  EXPECT_GT(draw_gaze(speaker, 60 * 3600, same).shifts.size(), gaze.shifts.size() / 2 + 60);
}

TEST(Gaze, DegenerateLengths) {
  Rng rng(6);
  EXPECT_TRUE(draw_gaze({}, 0, rng).x_deg.empty());
  EXPECT_EQ(draw_gaze({}, 1, rng).x_deg.size(), 1u);
}

TEST(Brows, RaiseAtTheAskedShareOfAccents) {
  Utterance utterance;
  utterance.seconds = 2000;
  for (double t = 2; t < 1998; t += 2) utterance.accents_s.push_back(t);
  Speaker speaker;
  Rng rng(7);
  const BrowTrack brows = draw_brows(speaker, utterance, 2000 * 60, rng);
  int raised = 0;
  double sum = 0;
  for (const double t : utterance.accents_s) {
    const auto centre = brows.raise.begin() + static_cast<std::ptrdiff_t>(t * 60);
    const float peak = *std::max_element(centre - 12, centre + 12);
    if (peak > 0.03f) ++raised, sum += peak;
  }
  EXPECT_NEAR(raised / static_cast<double>(utterance.accents_s.size()), 0.24, 0.04);
  EXPECT_NEAR(sum / raised, 0.22 * std::exp(0.045), 0.02);
  EXPECT_NEAR(sd_of(brows.drift), 0.018, 0.003);
}

TEST(Brows, QuestionsEndWithARaise) {
  Utterance utterance;
  utterance.seconds = 3;
  utterance.phones = {{.start_s = 0.5, .end_s = 2.4, .label = "aa", .visemes = {Viseme::AA}}};
  utterance.is_question = true;
  int raised = 0;
  Rng rng(8);
  for (int i = 0; i < 1000; ++i) {
    const BrowTrack brows = draw_brows({}, utterance, 180, rng);
    raised += brows.raise[135] > 0.03f;  // 2.25 s
    ASSERT_EQ(brows.raise[60], 0);
  }
  EXPECT_NEAR(raised / 1000.0, 0.6, 0.05);
}

TEST(Head, SwaysAndNods) {
  const auto num = static_cast<std::int64_t>(kHour * 60);
  const std::vector<float> still(static_cast<std::size_t>(num), 0.0f);
  Speaker speaker;
  Rng rng(9);
  const HeadTrack head = draw_head(speaker, {}, {still, still, {}}, rng);
  EXPECT_NEAR(sd_of(head.yaw_deg), 1.2 * 1.1, 0.15);
  EXPECT_NEAR(sd_of(head.pitch_deg), 1.1, 0.12);
  EXPECT_NEAR(sd_of(head.roll_deg), 0.6 * 1.1, 0.08);

  Utterance utterance;
  for (double t = 5; t < 3590; t += 5) utterance.accents_s.push_back(t);
  Rng same(9);
  const HeadTrack nodding = draw_head(speaker, utterance, {still, still, {}}, same);
  int nods = 0;
  double sum = 0;
  for (const double t : utterance.accents_s) {
    double deepest = 0;
    for (auto n = static_cast<std::size_t>(t * 60) - 15; n < static_cast<std::size_t>(t * 60) + 20; ++n)
      deepest = std::min<double>(deepest, nodding.pitch_deg[n] - head.pitch_deg[n]);
    if (deepest < -0.3) ++nods, sum += deepest;
  }
  EXPECT_NEAR(nods / static_cast<double>(utterance.accents_s.size()), 0.35, 0.05);
  EXPECT_NEAR(sum / nods, -2.4 * std::exp(0.045), 0.25);
  EXPECT_EQ(nodding.yaw_deg, head.yaw_deg);

  const std::vector<float> right(static_cast<std::size_t>(num), -20.0f);
  Rng again(9);
  const HeadTrack following = draw_head(speaker, {}, {right, still, {}}, again);
  EXPECT_NEAR(following.yaw_deg[100] - head.yaw_deg[100], -1.5, 1e-4);
}

TEST(SpeechActivity, IsOneInSpeechAndZeroInPauses) {
  Utterance utterance;
  utterance.seconds = 4;
  utterance.phones = {{.start_s = 1, .end_s = 2, .label = "aa", .visemes = {Viseme::AA}},
                      {.start_s = 2, .end_s = 3, .label = "s", .visemes = {Viseme::SS}}};
  const auto activity = speech_activity(utterance, 240);
  EXPECT_NEAR(activity[120], 1, 1e-5);
  EXPECT_NEAR(activity[30], 0, 1e-5);
  EXPECT_NEAR(activity[60], 0.5, 0.1);
  EXPECT_TRUE(speech_activity({}, 0).empty());
}

}  // namespace
}  // namespace mien
