#include "mien/train/coefficient_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>

namespace mien::train {
namespace {

TEST(ReplicatedWindow, RepeatsTheEnds) {
  const std::vector<float> values = {1, 10, 2, 20, 3, 30};
  EXPECT_EQ(replicated_window(values, 2, -2, 4), (std::vector<float>{1, 10, 1, 10, 1, 10, 2, 20}));
  EXPECT_EQ(replicated_window(values, 2, 2, 2), (std::vector<float>{3, 30, 3, 30}));
  EXPECT_THROW(replicated_window({}, 2, 0, 1), std::logic_error);
}

TEST(WindowStart, ReachesHalfAWindowBeyondBothEnds) {
  const auto starts = [](std::int64_t num_frames, std::int64_t window) {
    Rng random(3);
    std::set<std::int64_t> seen;
    for (int i = 0; i < 2000; ++i) seen.insert(draw_window_start(random, num_frames, window));
    return std::vector<std::int64_t>(seen.begin(), seen.end());
  };
  EXPECT_EQ(starts(7, 5), (std::vector<std::int64_t>{-2, -1, 0, 1, 2, 3, 4}));
  EXPECT_EQ(starts(1, 6), (std::vector<std::int64_t>{-3, -2, -1, 0})) << "shorter than half a window";
  Rng random(1);
  EXPECT_THROW(draw_window_start(random, 0, 5), std::logic_error);
}

TEST(EpochBatches, TakeEverySequenceOnce) {
  const EpochBatches seven{7, 3};
  EXPECT_EQ(seven.count(), 3);
  EXPECT_EQ(seven.size(0), 3);
  EXPECT_EQ(seven.size(2), 1) << "what is left";
  EXPECT_EQ(seven.size(5), 1) << "of the second epoch";
  EXPECT_EQ((EpochBatches{6, 3}.count()), 2);
  EXPECT_EQ((EpochBatches{6, 3}.size(1)), 3);
  EXPECT_EQ((EpochBatches{1, 8}.size(41)), 1);
}

TEST(Mirror, ExchangesLeftAndRight) {
  const std::vector<std::string> names = {"jawOpen", "mouthLeft", "mouthRight", "cheekSquintLeft"};
  const auto order = mirror_order(names);
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 2, 1, 3})) << "a side without the other stays";
  std::vector<float> frames = {1, 2, 3, 4, 5, 6, 7, 8};
  mirror_coefficients(frames, order);
  EXPECT_EQ(frames, (std::vector<float>{1, 3, 2, 4, 5, 7, 6, 8}));
}

}  // namespace
}  // namespace mien::train
