#include "mien/datasets/layout.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace mien {
namespace {

std::string_view split(DatasetKind kind, std::string_view name) {
  const auto parts = parse_sequence_name(kind, name);
  return parts ? split_of(kind, *parts).value_or("none") : "no name";
}

TEST(DatasetLayout, HasTheWidthsAndRatesOfTheSpecification) {
  EXPECT_EQ(dataset_layout(DatasetKind::biwi).width, 3 * 23370);
  EXPECT_EQ(dataset_layout(DatasetKind::vocaset).width, 3 * 5023);
  EXPECT_EQ(dataset_layout(DatasetKind::multiface).width, 3 * 6172);
  EXPECT_EQ(dataset_layout(DatasetKind::beat).width, 51);
  EXPECT_EQ(dataset_layout(DatasetKind::uudamm).width, 192);
  EXPECT_EQ(dataset_layout(DatasetKind::vocaset).fps * dataset_layout(DatasetKind::vocaset).keep_every, 60);
  for (const auto name : dataset_names()) EXPECT_EQ(dataset_layout(*parse_dataset_kind(name)).name, name);
  EXPECT_FALSE(parse_dataset_kind("BIWI2"));
}

TEST(DatasetLayout, FullDataSetsSplitIntoTheStatedNumbers) {
  const auto count = [](DatasetKind kind, std::string_view wanted, auto name, int last) {
    std::vector<std::string> subjects;
    for (const auto& rule : dataset_layout(kind).splits)
      for (const auto& s : rule.subjects)
        if (std::find(subjects.begin(), subjects.end(), s) == subjects.end()) subjects.push_back(s);
    std::int64_t found = 0;
    for (const auto& subject : subjects)
      for (int sentence = 1; sentence <= last; ++sentence)
        found += split(kind, subject + name(sentence)) == wanted ? 1 : 0;
    return found;
  };
  const auto e = [](int n) { return "_e" + std::string(n < 10 ? "0" : "") + std::to_string(n); };
  const auto plain = [](int n) { return "_" + std::to_string(n); };
  const auto sentence = [](int n) {
    return "_sentence" + std::string(n < 10 ? "0" : "") + std::to_string(n);
  };
  for (const auto& rule : dataset_layout(DatasetKind::biwi).splits)
    EXPECT_EQ(count(DatasetKind::biwi, rule.split, e, 40), rule.expected) << rule.split;
  for (const auto& rule : dataset_layout(DatasetKind::vocaset).splits)
    EXPECT_EQ(count(DatasetKind::vocaset, rule.split, sentence, 40), rule.expected) << rule.split;
  for (const auto& rule : dataset_layout(DatasetKind::multiface).splits)
    EXPECT_EQ(count(DatasetKind::multiface, rule.split, plain, 50), rule.expected) << rule.split;
}

TEST(DatasetLayout, NamesAndSplitsOfSingleSequences) {
  EXPECT_EQ(split(DatasetKind::biwi, "F2_e32"), "train");
  EXPECT_EQ(split(DatasetKind::biwi, "F2_e33"), "val");
  EXPECT_EQ(split(DatasetKind::biwi, "F1_e33"), "none");
  EXPECT_EQ(split(DatasetKind::biwi, "F1_e40"), "test");
  EXPECT_EQ(split(DatasetKind::biwi, "F2_32"), "no name");
  EXPECT_EQ(split(DatasetKind::biwi_expressive, "F1_76"), "train");
  EXPECT_EQ(split(DatasetKind::biwi_expressive, "F1_38"), "val");
  EXPECT_EQ(split(DatasetKind::biwi_expressive, "M6_79"), "test");
  EXPECT_EQ(split(DatasetKind::vocaset, "FaceTalk_170809_00138_TA_sentence21"), "test");
  EXPECT_EQ(split(DatasetKind::vocaset, "FaceTalk_170809_00138_TA_sentence20"), "none");
  EXPECT_EQ(split(DatasetKind::multiface, "13_45"), "val");
  EXPECT_EQ(split(DatasetKind::multiface, "1_45"), "none");
  const auto beat = parse_sequence_name(DatasetKind::beat, "2_7_131");
  ASSERT_TRUE(beat);
  EXPECT_EQ(beat->subject, "2");
  EXPECT_EQ(beat->emotion, 7);
  EXPECT_EQ(beat->sentence, 131);
  for (const char* name :
       {"", "_", "F2", "F2_", "_e01", "F2_e", "F2_e-1", "F2_exx", "F2_e99999999999999999999"})
    EXPECT_FALSE(parse_sequence_name(DatasetKind::biwi, name)) << name;
  EXPECT_FALSE(parse_sequence_name(DatasetKind::beat, "2_01"));
}

TEST(DatasetLayout, The3DMeadSplitsIntoTheStatedNumbers) {
  const auto count = [](DatasetKind kind, std::string_view wanted) {
    std::int64_t found = 0;
    for (const auto& rule : dataset_layout(DatasetKind::mead_prior).splits)
      for (const auto& subject : rule.subjects)
        for (int emotion = 0; emotion < 8; ++emotion)
          for (int intensity = 0; intensity < (emotion == 0 ? 1 : 3); ++intensity)
            for (int sentence = 1; sentence <= (emotion == 0 ? 40 : 30); ++sentence) {
              const std::string number = std::to_string(1000 + sentence).substr(1);
              found += split(kind, subject + "_" + number + "_" + std::to_string(emotion) + "_" +
                                       std::to_string(intensity)) == wanted
                           ? 1
                           : 0;
            }
    return found;
  };
  for (const auto kind : {DatasetKind::mead, DatasetKind::mead_prior, DatasetKind::mead_vertices})
    for (const auto& rule : dataset_layout(kind).splits)
      EXPECT_EQ(count(kind, rule.split), rule.expected) << dataset_layout(kind).name << rule.split;
  EXPECT_EQ(split(DatasetKind::mead, "M003_032_0_0"), "train");
  EXPECT_EQ(split(DatasetKind::mead, "M003_030_7_2"), "test");
  EXPECT_EQ(split(DatasetKind::mead, "M032_001_0_0"), "none");
  for (const char* name : {"M003", "M003_001", "M003_001_0", "_001_0_0", "M003_001_8_0", "M003_001_0_3",
                           "M003_x_0_0", "M003_001_0_-1", "M003_001_0_0_"})
    EXPECT_EQ(split(DatasetKind::mead, name), "no name") << name;
}

TEST(DatasetLayout, UudammsSplitIsCutFromPythonsShuffle) {
  const auto order = python_shuffle(2537, 1);
  const std::vector<int> first = {2181, 1873, 1585, 2479, 488, 575, 2529, 933, 969, 1297};
  const std::vector<int> val = {968, 1673, 788, 430, 1726, 2127, 2230, 2447, 2194, 2496};
  const std::vector<int> test = {1165, 539, 2282, 2472, 712, 1287, 1791, 1124, 403, 1021};
  EXPECT_TRUE(std::equal(first.begin(), first.end(), order.begin()));
  EXPECT_TRUE(std::equal(val.begin(), val.end(), order.begin() + 80));
  EXPECT_TRUE(std::equal(test.begin(), test.end(), order.begin() + 90));
  EXPECT_EQ(split(DatasetKind::uudamm, "1_2181"), "train");
  EXPECT_EQ(split(DatasetKind::uudamm, "2_968"), "val");
  EXPECT_EQ(split(DatasetKind::uudamm, "1_1021"), "test");
  auto sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (int i = 0; i < 2537; ++i) ASSERT_EQ(sorted[static_cast<std::size_t>(i)], i + 1);
  EXPECT_TRUE(python_shuffle(0, 1).empty());
}

TEST(DatasetLayout, BeatsEmotionsEndBeforeTheUpperBound) {
  EXPECT_EQ(beat_emotion(0), 0);
  EXPECT_EQ(beat_emotion(65), 1);
  EXPECT_EQ(beat_emotion(71), 1);
  EXPECT_EQ(beat_emotion(72), 0);
  EXPECT_EQ(beat_emotion(73), 2);
  EXPECT_EQ(beat_emotion(117), 7);
  EXPECT_EQ(beat_emotion(118), 0);
}

}  // namespace
}  // namespace mien
