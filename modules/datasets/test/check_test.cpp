#include "mien/datasets/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "mien/base/file.h"
#include "mien/io/npy.h"
#include "test_folder.h"
#include "tiny_data.h"

namespace mien {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

Result<DatasetReport> check(const std::filesystem::path& folder,
                            std::optional<DatasetKind> kind = std::nullopt, bool read_values = false) {
  auto dataset = open_dataset(folder, kind);
  if (!dataset) return dataset.error();
  Progress progress;
  return check_dataset(*dataset, {.read_values = read_values}, progress);
}

TEST(Dataset, IsListedWithSplitsTemplatesAndRates) {
  const TestFolder folder;
  tiny::write_prepared(DatasetKind::vocaset, folder.path(),
                       {"FaceTalk_170728_03272_TA_sentence01", "FaceTalk_170809_00138_TA_sentence21"});
  const auto dataset = open_dataset(folder.path());
  ASSERT_TRUE(dataset) << dataset.error().message();
  EXPECT_EQ(dataset->layout->kind, DatasetKind::vocaset);  // by its names
  ASSERT_EQ(dataset->sequences.size(), 2u);
  EXPECT_EQ(dataset->sequences[0].split, "train");
  EXPECT_EQ(dataset->sequences[1].split, "test");
  EXPECT_EQ(dataset->templates.size(), 2u);
  const auto motion = load_sequence(*dataset, dataset->sequences[0]);
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_EQ(motion->fps, 30);
  EXPECT_EQ(motion->num_frames(), 30);      // of 60 stored ones
  EXPECT_FLOAT_EQ(motion->frame(3)[0], 6);  // every second
}

TEST(Dataset, EveryLayoutIsReadInItsTrueForm) {
  const std::pair<DatasetKind, std::vector<std::string>> cases[] = {
      {DatasetKind::biwi, {"F2_e01", "F2_e33", "F1_e37"}},
      {DatasetKind::biwi_expressive, {"F1_01", "F1_37", "F1_79"}},
      {DatasetKind::vocaset,
       {"FaceTalk_170728_03272_TA_sentence01", "FaceTalk_170811_03275_TA_sentence21",
        "FaceTalk_170809_00138_TA_sentence21"}},
      {DatasetKind::multiface, {"2_1", "2_41", "1_46"}},
      {DatasetKind::uudamm, {"1_2181", "1_968", "1_1021"}},
      {DatasetKind::mead, {"M003_001_0_0", "M003_025_1_2", "W029_028_7_0"}},
      {DatasetKind::mead_prior, {"M003_040_0_0", "M032_001_1_2", "M037_028_7_0"}},
      {DatasetKind::mead_vertices, {"M003_001_0_0", "M003_025_1_2", "W029_028_7_0"}}};
  for (const auto& [kind, names] : cases) {
    const TestFolder folder;
    tiny::write_prepared(kind, folder.path(), names);
    const auto report = check(folder.path(), kind, true);
    ASSERT_TRUE(report) << report.error().message();
    EXPECT_THAT(report->problems, IsEmpty()) << dataset_layout(kind).name;
    ASSERT_EQ(report->splits.size(), 3u);
    for (const auto& split : report->splits) EXPECT_EQ(split.found, 1) << split.split;
    const auto dataset = open_dataset(folder.path(), kind);
    for (const auto& sequence : dataset->sequences) {
      const auto motion = load_sequence(*dataset, sequence);
      ASSERT_TRUE(motion) << motion.error().message();
      EXPECT_EQ(motion->num_frames(), static_cast<std::int64_t>(motion->fps));
    }
  }
}

TEST(Dataset, BeatIsSplitByEmotionAndSubject) {
  const TestFolder folder;
  std::vector<std::string> names;
  for (int i = 1; i <= 20; ++i) names.push_back("2_3_" + std::to_string(i));
  tiny::write_prepared(DatasetKind::beat, folder.path(), names);
  const auto report = check(folder.path());
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_THAT(report->problems, IsEmpty());
  EXPECT_EQ(report->splits[0].found, 16);
  EXPECT_EQ(report->splits[1].found, 2);
  EXPECT_EQ(report->splits[2].found, 2);
  const auto once = open_dataset(folder.path()), again = open_dataset(folder.path());
  for (std::size_t i = 0; i < once->sequences.size(); ++i)
    EXPECT_EQ(once->sequences[i].split, again->sequences[i].split);
  EXPECT_EQ(load_sequence(*once, once->sequences[0])->channels[0], "browDownLeft");
}

TEST(Dataset, The3DMeadIsFoundByItsFolders) {
  const TestFolder parameters, meshes;
  tiny::write_prepared(DatasetKind::mead, parameters.path(), {"M003_001_0_0", "W011_040_0_0"});
  tiny::write_prepared(DatasetKind::mead_vertices, meshes.path(), {"M003_001_0_0"});
  const auto dataset = open_dataset(parameters.path());
  ASSERT_TRUE(dataset) << dataset.error().message();
  EXPECT_EQ(dataset->layout->kind, DatasetKind::mead);
  EXPECT_EQ(dataset->sequences[0].parts.intensity, 0);
  EXPECT_EQ(dataset->sequences[1].split, "test");
  const auto motion = load_sequence(*dataset, dataset->sequences[0]);
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_EQ(motion->space, MotionSpace::flame);
  EXPECT_EQ(motion->num_frames(), 25);
  EXPECT_EQ(motion->find("jaw_x"), 400);
  EXPECT_FLOAT_EQ(motion->frame(3)[400], 3.4f);
  EXPECT_EQ(open_dataset(meshes.path())->layout->kind, DatasetKind::mead_vertices);
}

TEST(Dataset, MotionWithoutSoundCountsWhereNoneIsHeard) {
  const TestFolder folder;
  tiny::write_prepared(DatasetKind::mead, folder.path(), {"M003_001_0_0", "M003_002_0_0"});
  std::filesystem::remove(folder.path() / "wav/M003_001_0_0.wav");
  EXPECT_EQ(open_dataset(folder.path())->unpaired_motion, std::vector<std::string>{"M003_001_0_0"});
  EXPECT_EQ(open_dataset(folder.path(), DatasetKind::mead_prior)->sequences.size(), 2u);
  std::filesystem::remove_all(folder.path() / "wav");
  EXPECT_FALSE(open_dataset(folder.path()));
  const auto silent = check(folder.path(), DatasetKind::mead_prior, true);
  ASSERT_TRUE(silent) << silent.error().message();
  EXPECT_THAT(silent->problems, IsEmpty());
  EXPECT_EQ(silent->splits[0].num_frames, 50);
}

TEST(DatasetCheck, NamesWhatIsMissingAndOdd) {
  const TestFolder folder;
  tiny::write_prepared(DatasetKind::biwi, folder.path(), {"F2_e01", "F2_e02", "F3_e01", "F9_e01"});
  std::filesystem::remove(folder.path() / "wav" / "F2_e02.wav");
  tiny::write_sound(folder.path() / "wav" / "F4_e01.wav", 1);
  tiny::write_ramp(folder.path() / "vertices_npy" / "stranger.npy", 3, 12);
  tiny::write_sound(folder.path() / "wav" / "F3_e01.wav", 3);
  const auto report = check(folder.path());
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_THAT(report->problems, IsEmpty());
  EXPECT_THAT(report->oddities, Contains(HasSubstr("motion without sound (left out): F2_e02")));
  EXPECT_THAT(report->oddities, Contains(HasSubstr("sound without motion (left out): F4_e01")));
  EXPECT_THAT(report->oddities, Contains(HasSubstr("none of biwi (left out): stranger")));
  EXPECT_THAT(report->oddities, Contains(HasSubstr("F3_e01 (3.00 s, 1.00 s)")));
  EXPECT_THAT(report->oddities, Contains(HasSubstr("12 numbers, those of biwi hold 70110")));
  EXPECT_THAT(report->oddities, Contains(HasSubstr("train (2 of 192)")));
  EXPECT_EQ(report->splits.back().split, "none");  // F9 is no subject of BIWI's
  EXPECT_EQ(report->splits.back().found, 1);
}

TEST(DatasetCheck, NamesWhatWouldFail) {
  const TestFolder folder;
  tiny::write_prepared(DatasetKind::multiface, folder.path(), {"2_1", "2_2", "3_1", "6_1", "7_1"});
  tiny::write_ramp(folder.path() / "vertices_npy" / "2_2.npy", 30, 15);
  ASSERT_TRUE(write_file(folder.path() / "vertices_npy" / "3_1.npy", std::string_view("no array")));
  ASSERT_TRUE(write_file(folder.path() / "wav" / "2_1.wav", std::string_view("no sound")));
  NpyArray broken{{30, 12}, std::vector<float>(360)};
  broken.values[100] = std::numeric_limits<float>::infinity();
  ASSERT_TRUE(
      write_file(folder.path() / "vertices_npy" / "6_1.npy", std::span<const std::byte>(write_npy(broken))));
  Templates templates = load_templates(folder.path() / "templates.safetensors").value();
  templates.erase("7");
  ASSERT_TRUE(write_templates(folder.path() / "templates.safetensors", templates));
  const auto report = check(folder.path(), DatasetKind::multiface, true);
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_THAT(report->problems, Contains(HasSubstr("15 numbers")));
  EXPECT_THAT(report->problems, Contains(HasSubstr("motion is damaged")));
  EXPECT_THAT(report->problems, Contains(HasSubstr("sound cannot be read")));
  EXPECT_THAT(report->problems, Contains(HasSubstr("not finite: 6_1")));
  EXPECT_THAT(report->problems, Contains(HasSubstr("subjects without a template: 7")));
  std::filesystem::remove(folder.path() / "templates.safetensors");
  EXPECT_THAT(check(folder.path(), DatasetKind::multiface)->problems, Contains(HasSubstr("templates.pkl")));
}

TEST(DatasetCheck, EmptyAndMissingFolders) {
  const TestFolder folder;
  EXPECT_EQ(check(folder.path()).error().code, Errc::input);
  EXPECT_EQ(check(folder.path() / "nowhere").error().code, Errc::input);
  std::filesystem::create_directories(folder.path() / "wav");
  std::filesystem::create_directories(folder.path() / "vertices_npy");
  EXPECT_EQ(check(folder.path()).error().code, Errc::incompatible);  // which data set?
  const auto report = check(folder.path(), DatasetKind::beat);
  ASSERT_TRUE(report);
  EXPECT_FALSE(report->problems.empty());
}

TEST(Dataset, ArraysOfAnotherKindAreErrors) {
  const TestFolder folder;
  tiny::write_prepared(DatasetKind::beat, folder.path(), {"2_3_01"});
  const auto dataset = open_dataset(folder.path(), DatasetKind::beat);
  for (const std::vector<std::int64_t>& shape :
       {std::vector<std::int64_t>{51}, {2, 50}, {0, 1ll << 40, 1ll << 40}, {2, 51, 1, 1}}) {
    std::size_t count = 1;
    for (const auto size : shape) count *= static_cast<std::size_t>(size);
    ASSERT_TRUE(write_file(dataset->sequences[0].motion,
                           std::span<const std::byte>(write_npy({shape, std::vector<float>(count)}))));
    EXPECT_FALSE(load_sequence(*dataset, dataset->sequences[0])) << shape.size();
  }
}

}  // namespace
}  // namespace mien
