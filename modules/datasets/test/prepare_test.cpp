#include "mien/datasets/prepare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mien/audio/load_audio.h"
#include "mien/base/file.h"
#include "mien/datasets/check.h"
#include "mien/datasets/scaling.h"
#include "mien/io/vl.h"
#include "test_folder.h"
#include "tiny_data.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

TEST(Scaling, OfABoxSpansOneAndCanBeUndone) {
  const std::vector<float> neutral = {0, 10, -1, 2, 30, 1, 4, 20, 3};
  const auto scale = box_scale(neutral);
  ASSERT_TRUE(scale);
  std::vector<float> scaled = neutral;
  apply_scale(*scale, scaled);
  EXPECT_THAT(scaled, testing::Pointwise(testing::FloatNear(1e-6f),
                                         std::vector<float>{-0.5f, -0.5f, -0.5f, 0, 0.5f, 0, 0.5f, 0, 0.5f}));
  undo_scale(*scale, scaled);
  EXPECT_THAT(scaled, testing::Pointwise(testing::FloatNear(1e-5f), neutral));
  EXPECT_EQ(box_scale({}).error().code, Errc::input);
  EXPECT_EQ(box_scale(std::vector<float>{0, 0, 0, 1, 1, 0}).error().code, Errc::input);
}

TEST(Scaling, OfMultifaceReachesOneAtItsBounds) {
  std::vector<float> corners = {-117.798f, -213.735f, -177.091f, 125.922f, 185.79601f, 75.365097f};
  apply_scale(multiface_scale(), corners);
  EXPECT_THAT(corners,
              testing::Pointwise(testing::FloatNear(1e-6f), std::vector<float>{-1, -1, -1, 1, 1, 1}));
}

TEST(Scaling, ByAreaIsIndependentOfSizeAndPlace) {
  const std::vector<std::array<std::uint32_t, 3>> triangles = {{0, 1, 2}};
  std::vector<float> small = {0, 0, 0, 2, 0, 0, 0, 2, 0};  // area 2
  std::vector<float> large = {5, -7, 1, 25, -7, 1, 5, 13, 1};
  ASSERT_TRUE(scale_by_area(triangles, small));
  ASSERT_TRUE(scale_by_area(triangles, large));
  EXPECT_THAT(large, testing::Pointwise(testing::FloatNear(1e-6f), small));
  EXPECT_NEAR(small[3] - small[0], 2 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(small[7] - small[1], -2 / std::sqrt(2.0), 1e-6);  // turned about x
  std::vector<float> flat(9, 1);
  EXPECT_EQ(scale_by_area(triangles, flat).error().code, Errc::input);
}

// Recordings of one subject as the makers of BIWI deliver them, and its template.
void write_biwi(const fs::path& raw) {
  tiny::write_vl_frames(raw / "faces" / "F1" / "01", 12);
  tiny::write_vl_frames(raw / "faces" / "F1_e07", 3);
  tiny::write_vl_frames(raw / "faces" / "F1" / "e09", 2);  // without sound
  tiny::write_sound(raw / "audio" / "F1_01_cut.wav", 0.5);
  tiny::write_sound(raw / "audio" / "F1_e07.wav", 0.2);
  ASSERT_TRUE(write_templates(raw / "original.safetensors", {{"F1", {0, 0, 0, 2, 0, 0, 0, 10, 4}}}));
  ASSERT_TRUE(write_file(raw / "mesh.obj", std::string_view("v 0 0 0\nv 2 0 0\nv 0 10 4\nf 1 2 3\n")));
}

TEST(Prepare, BiwiForFaceXHuBERT) {
  const TestFolder raw, out;
  write_biwi(raw.path());
  Progress progress;
  const auto report =
      prepare_dataset(DatasetKind::biwi_expressive, raw.path(), out.path(),
                      {.templates = raw.path() / "original.safetensors", .mesh = {}}, progress);
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->num_sequences, 2);
  EXPECT_EQ(report->num_frames, 15);
  EXPECT_THAT(report.warnings, testing::Contains(testing::HasSubstr("F1_e09 is left out: no sound")));
  const auto dataset = open_dataset(out.path(), DatasetKind::biwi_expressive);
  ASSERT_TRUE(dataset) << dataset.error().message();
  ASSERT_EQ(dataset->sequences.size(), 2u);
  EXPECT_EQ(dataset->sequences[0].name, "F1_01");
  EXPECT_EQ(dataset->sequences[1].name, "F1_47");  // e07
  const auto motion = load_sequence(*dataset, dataset->sequences[0]);
  ASSERT_TRUE(motion);
  ASSERT_EQ(motion->num_frames(), 12);
  // y of the last vertex: (n - 10 / 3) / 10 for frame n = 1 ... 12, in the order of the numbers.
  EXPECT_NEAR(motion->frame(0)[7], (1 - 10 / 3.0) / 10, 1e-6);
  EXPECT_NEAR(motion->frame(9)[7], (10 - 10 / 3.0) / 10, 1e-6);
  EXPECT_NEAR(dataset->templates.at("F1")[7], (10 - 10 / 3.0) / 10, 1e-6);
  EXPECT_TRUE(check_dataset(*dataset, {}, progress)->problems.empty());
}

TEST(Prepare, BiwiForFaceDiffuserTakesEmotionalReadings) {
  const TestFolder raw, out;
  write_biwi(raw.path());
  Progress progress;
  const auto report = prepare_dataset(DatasetKind::biwi, raw.path(), out.path(),
                                      {.templates = {}, .mesh = raw.path() / "mesh.obj"}, progress);
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->num_sequences, 1);
  const auto dataset = open_dataset(out.path());
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->layout->kind, DatasetKind::biwi);
  const auto motion = load_sequence(*dataset, dataset->sequences.at(0));
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(motion->frame(1)[axis] + motion->frame(1)[axis + 3] + motion->frame(1)[axis + 6], 0, 1e-6);
}

TEST(Prepare, BeatInPiecesOfTenSeconds) {
  const TestFolder raw, out;
  tiny::write_beat_json(raw.path() / "2" / "2_scott_0_65_65.json", 1300);  // two pieces and a rest
  tiny::write_sound(raw.path() / "2" / "2_scott_0_65_65.wav", 21.7);
  tiny::write_beat_json(raw.path() / "2" / "2_scott_0_72_72.json", 600);  // the end point counts as neutral
  tiny::write_sound(raw.path() / "2" / "2_scott_0_72_72.wav", 10);
  tiny::write_beat_json(raw.path() / "2" / "2_scott_1_1_1.json", 600);  // conversation
  tiny::write_beat_json(raw.path() / "4" / "4_x_0_1_1.json", 600);      // without sound
  Progress progress;
  const auto report = prepare_dataset(DatasetKind::beat, raw.path(), out.path(), {}, progress);
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->num_sequences, 3);
  EXPECT_EQ(report.warnings.size(), 1u);
  const auto dataset = open_dataset(out.path());
  ASSERT_TRUE(dataset) << dataset.error().message();
  ASSERT_EQ(dataset->sequences.size(), 3u);
  EXPECT_EQ(dataset->sequences[0].name, "2_0_03");
  EXPECT_EQ(dataset->sequences[1].name, "2_1_01");
  const auto second = load_sequence(*dataset, dataset->sequences[2]);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->num_frames(), 300);
  EXPECT_FLOAT_EQ(second->frame(1)[0], 0.602f);  // frame 602 of the recording
  const auto sound = load_audio(dataset->sequences[2].audio);
  ASSERT_TRUE(sound);
  EXPECT_EQ(sound->samples.size(), 160000u);
  EXPECT_NEAR(sound->samples[1], 0.1 * std::sin(0.1 * 160001), 1e-4);
}

TEST(Prepare, WhatCannotBePreparedIsAnError) {
  const TestFolder raw, out;
  Progress progress;
  const auto code = [&](DatasetKind kind, const PrepareOptions& options) {
    const auto report = prepare_dataset(kind, raw.path(), out.path(), options, progress);
    return report ? Errc::failed : report.error().code;
  };
  EXPECT_EQ(code(DatasetKind::multiface, {}), Errc::usage);
  EXPECT_EQ(code(DatasetKind::biwi, {}), Errc::usage);
  EXPECT_EQ(code(DatasetKind::biwi_expressive, {}), Errc::usage);
  EXPECT_EQ(code(DatasetKind::beat, {}), Errc::input);
  write_biwi(raw.path());
  const PrepareOptions options{.templates = raw.path() / "original.safetensors", .mesh = {}};
  ASSERT_TRUE(write_file(raw.path() / "faces" / "F1" / "01" / "frame_005.vl", std::string_view("cut")));
  EXPECT_EQ(code(DatasetKind::biwi_expressive, options), Errc::input);
  ASSERT_TRUE(write_file(raw.path() / "faces" / "F1" / "01" / "frame_005.vl",
                         std::span<const std::byte>(write_vl(std::vector<Vec3>(4)))));
  EXPECT_EQ(code(DatasetKind::biwi_expressive, options), Errc::incompatible);
  tiny::write_beat_json(raw.path() / "2_x_0_1_1.json", 600, 50);
  tiny::write_sound(raw.path() / "2_x_0_1_1.wav", 10);
  EXPECT_EQ(code(DatasetKind::beat, {}), Errc::input);
}

}  // namespace
}  // namespace mien
