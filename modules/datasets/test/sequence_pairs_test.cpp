#include "mien/datasets/sequence_pairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_folder.h"
#include "tiny_data.h"

namespace mien {
namespace {

using testing::ElementsAre;

// Two folders with empty arrays of these names.
struct Folders {
  TestFolder predicted, truth;
  Folders(const std::vector<std::string>& predictions, const std::vector<std::string>& truths) {
    for (const auto& name : predictions) tiny::write_ramp(predicted.path() / (name + ".npy"), 1, 3);
    for (const auto& name : truths) tiny::write_ramp(truth.path() / (name + ".npy"), 1, 3);
  }
  [[nodiscard]] Result<PairedSequences> pair(PairRule rule) const {
    return pair_sequences(predicted.path(), truth.path(), rule);
  }
};

std::vector<std::string> names_of(const PairedSequences& paired) {
  std::vector<std::string> names;
  for (const auto& pair : paired.pairs)
    names.push_back(pair.predicted.stem().string() + "|" + pair.truth.stem().string());
  return names;
}

TEST(SequencePairs, ComparePredictionsInTheirOwnStyle) {
  const Folders folders(
      {"F2_e37_condition_F2", "F2_e37_condition_F3", "F3_e37_condition_F3_1", "F3_e37_condition_F3_2",
       "M4_e37", "F1_e37_condition_F2", "F1_e37_condition_F3", "F5_e37_condition_F2", "F2_e99"},
      {"F2_e37", "F3_e37", "M4_e37", "F1_e37", "F2_e40"});
  const auto paired = folders.pair(PairRule::vertices);
  ASSERT_TRUE(paired) << paired.error().message();
  EXPECT_THAT(names_of(*paired), ElementsAre("F2_e37_condition_F2|F2_e37", "F3_e37_condition_F3_1|F3_e37",
                                             "F3_e37_condition_F3_2|F3_e37", "M4_e37|M4_e37"));
  EXPECT_EQ(paired->pairs[0].subject, "F2");
  ASSERT_EQ(paired->takes.size(), 1u);  // F5 has one condition alone
  EXPECT_EQ(paired->takes.at("F1_e37").size(), 2u);
  EXPECT_THAT(paired->without_truth, ElementsAre("F2_e99"));
  EXPECT_THAT(paired->without_prediction, ElementsAre("F2_e40"));
}

TEST(SequencePairs, SubjectsMayHaveUnderscores) {
  const Folders folders({"FaceTalk_1_TA_sentence01_condition_FaceTalk_1_TA",
                         "FaceTalk_2_03_sentence01_condition_FaceTalk_2_03"},
                        {"FaceTalk_1_TA_sentence01", "FaceTalk_2_03_sentence01"});
  EXPECT_EQ(folders.pair(PairRule::vertices)->pairs.size(), 2u);
}

TEST(SequencePairs, ControlsGoByTheirFirstFields) {
  const Folders beat({"2_8_01_sample", "2_3_04"}, {"2_8_01", "2_3_04_truth"});
  EXPECT_THAT(names_of(*beat.pair(PairRule::beat)),
              ElementsAre("2_3_04|2_3_04_truth", "2_8_01_sample|2_8_01"));
  const Folders uudamm({"2_01_Damm", "1_02"}, {"2_01", "1_02"});
  EXPECT_EQ(uudamm.pair(PairRule::uudamm)->pairs.size(), 2u);
}

TEST(SequencePairs, TwoFilesAreMeant) {
  const Folders folders({"a"}, {"b"});
  const auto paired =
      pair_sequences(folders.predicted.path() / "a.npy", folders.truth.path() / "b.npy", PairRule::vertices);
  ASSERT_TRUE(paired);
  EXPECT_EQ(paired->pairs.size(), 1u);
}

TEST(SequencePairs, NothingToPairIsAnError) {
  EXPECT_EQ(Folders({"a", "b"}, {"c"}).pair(PairRule::vertices).error().code, Errc::input);
  EXPECT_EQ(Folders({}, {}).pair(PairRule::vertices).error().code, Errc::input);
  EXPECT_EQ(pair_sequences("nowhere", "nowhere", PairRule::vertices).error().code, Errc::input);
}

TEST(SequencePairs, GatherTheTakesOfASequence) {
  const Folders folders({"M003_001_0_0_M003_neutral_low(1)", "M003_001_0_0_M003_neutral_low(0)",
                         "M003_001_0_0_M003_neutral_low(10)", "M003_0011-2", "M003_0011-1", "other"},
                        {"M003_001_0_0", "M003_0011", "M003_001", "W009_001"});
  const auto paired = pair_takes(folders.predicted.path(), folders.truth.path());
  ASSERT_TRUE(paired) << paired.error().message();
  ASSERT_EQ(paired->sequences.size(), 2u);
  EXPECT_EQ(paired->sequences[0].sequence, "M003_0011");
  EXPECT_EQ(paired->sequences[0].takes.size(), 2u);
  EXPECT_EQ(paired->sequences[1].sequence, "M003_001_0_0") << "the longest name that fits";
  EXPECT_EQ(paired->sequences[1].takes.back().stem().string(), "M003_001_0_0_M003_neutral_low(10)");
  EXPECT_THAT(paired->without_truth, ElementsAre("other"));
  EXPECT_THAT(paired->without_prediction, ElementsAre("M003_001", "W009_001"));
  const Folders twice({"a_x-1", "a_y-1"}, {"a"});
  EXPECT_EQ(pair_takes(twice.predicted.path(), twice.truth.path()).error().code, Errc::input);
  const Folders none({"b"}, {"a"});
  EXPECT_EQ(pair_takes(none.predicted.path(), none.truth.path()).error().code, Errc::input);
}

}  // namespace
}  // namespace mien
