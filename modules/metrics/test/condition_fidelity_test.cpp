#include "mien/metrics/condition_fidelity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "performances_for_tests.h"

namespace mien {
namespace {

ConditionExample posed(int label, int context, double base, std::uint64_t seed) {
  Motion motion = test::noise(60, 0.05, seed);
  // A label raises 13 of the 52 curves, so that it outweighs the noise of the others.
  for (std::int64_t n = 0; n < 60; ++n)
    for (std::size_t c = 0; c < 13; ++c) motion.frame(n)[13 * static_cast<std::size_t>(label) + c] += 0.5f;
  for (float& v : motion.values) v += static_cast<float>(base);
  return {condition_features(motion), label, context};
}

std::vector<ConditionExample> examples(std::uint64_t seed, bool shuffled) {
  std::vector<ConditionExample> out;
  for (int label = 0; label < 4; ++label) {
    for (int context = 0; context < 2; ++context) {
      for (int i = 0; i < 5; ++i) {
        out.push_back(posed(shuffled ? i % 4 : label, context, 0.3 * context, seed++));
        out.back().label = label;
      }
    }
  }
  return out;
}

TEST(ConditionFidelity, FeaturesAreMeansAndDeviations) {
  Motion motion = test::still(4);
  test::set(motion, {"jawOpen"}, [](auto n) { return n < 2 ? 0.0 : 1.0; });
  const auto f = condition_features(motion);
  ASSERT_EQ(f.size(), 104u);
  EXPECT_NEAR(f[17], 0.5, 1e-9);
  EXPECT_NEAR(f[52 + 17], 0.5, 1e-9);
  EXPECT_EQ(condition_features(test::still(0))[17], 0);
}

TEST(ConditionFidelity, FindsWhatIsThereAndNothingElse) {
  const CentroidClassifier classifier(examples(1, false));
  EXPECT_DOUBLE_EQ(judge(classifier, examples(1000, false)).accuracy(), 1);
  EXPECT_LT(judge(classifier, examples(1000, true)).accuracy(), 0.5);  // poses that do not follow the label
}

TEST(ConditionFidelity, ContextsWithoutAChoiceAreLeftOut) {
  std::vector<ConditionExample> one = {posed(1, 7, 0, 1)};
  const CentroidClassifier classifier(one);
  EXPECT_EQ(classifier.num_labels(7), 1u);
  EXPECT_EQ(judge(classifier, one).total, 0);
  EXPECT_TRUE(std::isnan(judge(classifier, one).accuracy()));
  EXPECT_EQ(classifier.predict(one[0].features, 8), -1);
  EXPECT_EQ(CentroidClassifier({}).predict(one[0].features, 0), -1);
}

}  // namespace
}  // namespace mien
