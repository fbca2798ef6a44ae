#include "default/event_draw.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "mien/base/hash.h"

namespace mien::default_model {
namespace {

constexpr std::int64_t kWidth = 4, kConditionWidth = 3, kHidden = 5;

// Fills a path with random weights of the given scale.
class Fill : public ParameterVisitor<Fill> {
 public:
  explicit Fill(float scale) : scale_(scale) {}
  void matrix(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in, Init) {
    slot = PackedMatrix(values(name, out * in), out, in);
  }
  void tensor(std::string_view name, Tensor& slot, const Shape& shape, Init) {
    slot = Tensor(shape, values(name, std::accumulate(shape.begin(), shape.end(), std::int64_t{1},
                                                      std::multiplies<>())));
  }

 private:
  std::vector<float> values(std::string_view name, std::int64_t count) const {
    std::vector<float> out(static_cast<std::size_t>(count));
    NoiseField(hash64(full_name(name)), 0).normal(0, 0, out);
    for (float& v : out) v *= scale_;
    return out;
  }
  float scale_;
};

EventPath<Tensor> path_of(const EventKind& kind, float scale) {
  EventPath<Tensor> path(kind, kWidth, kConditionWidth, kHidden);
  Fill fill(scale);
  path.visit(fill);
  return path;
}

Tensor speech_of(float first_groups, float last_group) {
  Tensor speech({1, kContextGroups * kWidth});
  for (std::int64_t i = 0; i < speech.count(); ++i)
    speech.data()[i] = i < (kContextGroups - 1) * kWidth ? first_groups : last_group;
  return speech;
}

const Tensor kNobody({1, kConditionWidth});

TEST(EventDraw, PlacesACertainEventInItsFrame) {
  for (const EventKind& kind : {kBlinks, kBrowRaises}) {
    for (std::int64_t f = 0; f < kind.frames; ++f) {
      EventPath<Tensor> path = path_of(kind, 0);
      path.out.bias.data()[1 + f] = 60;
      if (kind.has_size) path.out.bias.data()[kind.num_classes()] = -0.75f;
      EventDraw draw(path, 3, 1);
      for (std::int64_t step = 0; step < 4; ++step) {
        const auto event = draw.step(speech_of(0, 0), kNobody, kNobody);
        ASSERT_TRUE(event);
        EXPECT_EQ(event->frame, step * kind.frames + kind.offset + f);
        EXPECT_EQ(event->log_size, kind.has_size ? -0.75 : 0);
      }
    }
  }
}

TEST(EventDraw, DrawsAsOftenAsItsPathSays) {
  EventPath<Tensor> path = path_of(kBrowRaises, 0);
  path.out.bias.data()[0] = std::log(16.0f);  // none: 16 of 20
  EventDraw draw(path, 9, 1);
  constexpr int kSteps = 8000;
  std::array<int, 4> count{};
  for (int step = 0; step < kSteps; ++step)
    if (const auto event = draw.step(speech_of(0, 0), kNobody, kNobody))
      ++count[static_cast<std::size_t>(event->frame - (4 * step - 2))];
  for (const int c : count) EXPECT_NEAR(c, kSteps / 20, 70);  // 3.5 standard deviations
}

TEST(EventDraw, SharpeningScalesTheOddsByThoseOfAnUnknownStyle) {
  EventPath<Tensor> path = path_of(kBrowRaises, 0);
  path.out.bias.data()[0] = std::log(16.0f);  // odds of an event: 4 to 16
  const auto count = [&](Sharpening sharpening) {
    EventDraw draw(path, 9, 1, sharpening);
    int events = 0;
    for (int step = 0; step < 8000; ++step)
      events += draw.step(speech_of(0, 0), kNobody, kNobody).has_value();
    return events;
  };
  EXPECT_NEAR(count({}), 1600, 125);
  EXPECT_NEAR(count({2, std::log(0.25)}), 1600, 125);    // neither for nor against
  EXPECT_NEAR(count({1, std::log(0.0625)}), 4000, 160);  // odds 4 times 0.25
  EXPECT_NEAR(count({1, 0}), 8000.0 / 17, 80);           // odds 0.25 times 0.25
}

TEST(EventDraw, ReadsTheGroupsOfItsKindOnly) {
  const auto sizes = [](float first_groups, float last_group) {
    const EventPath<Tensor> path = path_of(kBrowRaises, 0.5f);
    EventDraw draw(path, 5, 1);
    std::vector<double> out;
    for (int step = 0; step < 40; ++step)
      if (const auto event = draw.step(speech_of(first_groups, last_group), kNobody, kNobody))
        out.push_back(event->log_size);
    return out;
  };
  ASSERT_FALSE(sizes(0, 1).empty());
  EXPECT_EQ(sizes(0, 1), sizes(7, 1));
  EXPECT_NE(sizes(0, 1), sizes(0, 2));
}

TEST(EventHistory, TellsThePreviousClassAndTheTimeSinceTheLastOnset) {
  EventHistory history(kBrowRaises);
  EXPECT_EQ(history.numbers(), (std::vector<float>{1, 0, 0, 0, 0, static_cast<float>(std::log1p(1.6))}));
  history.add(3);
  EXPECT_EQ(history.numbers(), (std::vector<float>{0, 0, 0, 1, 0, 0}));
  history.add(0);
  EXPECT_EQ(history.numbers(), (std::vector<float>{1, 0, 0, 0, 0, static_cast<float>(std::log1p(4.0 / 60))}));
  EXPECT_EQ(EventHistory(kBlinks).numbers().back(), static_cast<float>(std::log1p(1.6)));
}

}  // namespace
}  // namespace mien::default_model
