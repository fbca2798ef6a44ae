#include "mien/train/early_stopping.h"

#include <gtest/gtest.h>

#include <limits>

namespace mien::train {
namespace {

using Monitor = EarlyStopping::Monitor;
using Losses = std::vector<double>;

TEST(EarlyStoppingTest, WaitsForTheLeastFigureOfTheEpochs) {
  EarlyStopping stopping(Monitor::epoch_mean, 2);
  EXPECT_TRUE(stopping.observe(Losses{4, 2}));
  EXPECT_EQ(stopping.figure(), 3);
  EXPECT_TRUE(stopping.observe(Losses{1}));
  EXPECT_FALSE(stopping.observe(Losses{1}));  // equal is not better
  EXPECT_FALSE(stopping.is_over());
  EXPECT_TRUE(stopping.observe(Losses{0.5}));
  EXPECT_FALSE(stopping.observe(Losses{2}));
  EXPECT_FALSE(stopping.observe(Losses{2}));
  EXPECT_TRUE(stopping.is_over());
}

// Means of 4; 4, 3: of (4), (4 + 2) / 2; then sums go on: (6 + 9) / 3 = 5, (15 + 1) / 4 = 4.
TEST(EarlyStoppingTest, TheRunningMeanIsOfAllStepsSinceTheBeginning) {
  EarlyStopping stopping(Monitor::running_mean, 5);
  EXPECT_TRUE(stopping.observe(Losses{4, 2}));
  EXPECT_EQ(stopping.figure(), 3.5);
  EXPECT_FALSE(stopping.observe(Losses{9, 1}));
  EXPECT_EQ(stopping.figure(), 4.5);
}

// What the published criterion costs: losses that rise again are still below the mean of all.
TEST(EarlyStoppingTest, TheRunningMeanFallsWhereTheLossesRise) {
  EarlyStopping published(Monitor::running_mean, 1), sane(Monitor::epoch_mean, 1);
  for (const double loss : {8.0, 1.0, 2.0, 3.0}) {
    EXPECT_FALSE(published.is_over());
    EXPECT_TRUE(published.observe(Losses{loss})) << loss;
    sane.observe(Losses{loss});
  }
  EXPECT_TRUE(sane.is_over());
}

TEST(EarlyStoppingTest, GoesOnFromItsState) {
  EarlyStopping whole(Monitor::running_mean, 3), before(Monitor::running_mean, 3),
      after(Monitor::running_mean, 3);
  const std::vector<Losses> epochs = {{0.3, 0.1}, {0.7}, {0.2, 0.25, 0.9}, {0.1}};
  for (std::size_t i = 0; i < epochs.size(); ++i) {
    whole.observe(epochs[i]);
    (i < 2 ? before : after).observe(epochs[i]);
    if (i == 1) after.entries().front().slot->copy_(*before.entries().front().slot);
  }
  EXPECT_EQ(after.figure(), whole.figure());
  EXPECT_FALSE(after.entries().front().trained) << "the optimiser would move it";
}

TEST(EarlyStoppingTest, NothingToLookAtAndNumbersThatAreNone) {
  EarlyStopping stopping(Monitor::epoch_mean, 1);
  EXPECT_FALSE(stopping.observe({}));
  EXPECT_FALSE(stopping.is_over()) << "nobody waits for a validation without sequences";
  EXPECT_FALSE(stopping.observe(Losses{std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_TRUE(stopping.is_over());
  EarlyStopping never(Monitor::epoch_mean, 0);
  for (int i = 0; i < 9; ++i) never.observe(Losses{1});
  EXPECT_FALSE(never.is_over());
  EXPECT_FALSE(parse_monitor("mean"));
}

}  // namespace
}  // namespace mien::train
