// VOCASET, Multiface and UUDaMM, small, in the forms in which they are delivered.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mien/audio/load_audio.h"
#include "mien/base/file.h"
#include "mien/datasets/check.h"
#include "mien/datasets/prepare.h"
#include "mien/datasets/scaling.h"
#include "mien/io/mesh_file.h"
#include "mien/io/npy.h"
#include "pickle_text.h"
#include "test_folder.h"
#include "tiny_data.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::FloatNear;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pointwise;

Result<PrepareReport> prepare(DatasetKind kind, const fs::path& raw, const fs::path& out,
                              const PrepareOptions& options = {}) {
  Progress progress;
  return prepare_dataset(kind, raw, out, options, progress);
}

std::vector<std::string> problems(const fs::path& folder, DatasetKind kind) {
  const auto dataset = open_dataset(folder, kind);
  if (!dataset) return {dataset.error().message()};
  Progress progress;
  return check_dataset(*dataset, {.read_values = true}, progress)->problems;
}

NpyArray array_of(const fs::path& path) {
  auto array = read_npy(*read_file(path));
  EXPECT_TRUE(array);
  return array ? std::move(*array) : NpyArray{};
}

using pickle_text::array;
using pickle_text::dict;
using pickle_text::number;
using pickle_text::text;

std::string sound(int num_samples, std::int16_t value) {
  return dict(
      {{text("audio"), array(std::vector<std::int16_t>(static_cast<std::size_t>(num_samples), value), "i2")},
       {text("sample_rate"), number(22000)}});
}

constexpr const char* kSubject = "FaceTalk_170728_03272_TA";

// Rows n of two vertices, all n; sentence01 has frames 0, 1, 2 in rows 4, 3, 5, sentence02 no sound.
void write_vocaset(const fs::path& raw) {
  NpyArray table{{6, 2, 3}, {}};
  for (int n = 0; n < 36; ++n) table.values.push_back(static_cast<float>(n / 6));
  ASSERT_TRUE(write_file(raw / "data_verts.npy", std::span<const std::byte>(write_npy(table))));
  const auto frames = [](const std::vector<std::pair<int, int>>& rows) {
    std::vector<std::pair<std::string, std::string>> entries;
    for (const auto& [frame, row] : rows) entries.emplace_back(number(frame), number(row));
    return dict(entries);
  };
  ASSERT_TRUE(write_file(
      raw / "subj_seq_to_idx.pkl",
      std::string_view(dict({{text(kSubject), dict({{text("sentence01"), frames({{1, 3}, {0, 4}, {2, 5}})},
                                                    {text("sentence02"), frames({{0, 0}})},
                                                    {text("../evil"), frames({{0, 0}})}})}}) +
                       ".")));
  ASSERT_TRUE(
      write_file(raw / "raw_audio_fixed.pkl",
                 std::string_view(dict({{text(kSubject), dict({{text("sentence01"), sound(1100, -16384)},
                                                               {text("../evil"), sound(10, 0)}})}}) +
                                  ".")));
  ASSERT_TRUE(
      write_file(raw / "templates.pkl",
                 std::string_view(dict({{text(kSubject), array(std::vector<float>(6, 0.5f), "f4")}}) + ".")));
}

TEST(PrepareVocaset, GathersFramesAndSound) {
  const TestFolder raw, out;
  write_vocaset(raw.path());
  const auto report = prepare(DatasetKind::vocaset, raw.path(), out.path());
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->num_sequences, 1);
  EXPECT_EQ(report->num_frames, 3);
  EXPECT_THAT(report.warnings, Contains(HasSubstr("sentence02 is left out: no sound")));
  EXPECT_THAT(report.warnings, Contains(HasSubstr("../evil is left out: its name")));
  const std::string name = std::string(kSubject) + "_sentence01";
  const NpyArray motion = array_of(out.path() / "vertices_npy" / (name + ".npy"));
  EXPECT_THAT(motion.shape, ElementsAre(3, 6));
  EXPECT_THAT((std::vector<float>{motion.values[0], motion.values[6], motion.values[12]}),
              ElementsAre(4, 3, 5));
  const auto clip = load_audio(out.path() / "wav" / (name + ".wav"));
  ASSERT_TRUE(clip) << clip.error().message();
  EXPECT_NEAR(clip->seconds(), 0.05, 1e-3);
  EXPECT_NEAR(clip->samples[400], -0.5f, 1e-3);
  EXPECT_THAT(problems(out.path(), DatasetKind::vocaset), IsEmpty());
  const auto dataset = open_dataset(out.path(), DatasetKind::vocaset);
  const auto loaded = load_sequence(*dataset, dataset->sequences[0]);
  EXPECT_EQ(loaded->num_frames(), 2);  // every second one, at 30 frames a second
  EXPECT_EQ(loaded->fps, 30);
}

TEST(PrepareVocaset, NamesWhatDoesNotFit) {
  const TestFolder raw, out;
  write_vocaset(raw.path());
  NpyArray small{{2, 2, 3}, std::vector<float>(12)};
  ASSERT_TRUE(write_file(raw / "data_verts.npy", std::span<const std::byte>(write_npy(small))));
  EXPECT_THAT(prepare(DatasetKind::vocaset, raw.path(), out.path()).error().message(),
              HasSubstr("not among the 2 of data_verts.npy"));
  small.shape = {4, 3};
  ASSERT_TRUE(write_file(raw / "data_verts.npy", std::span<const std::byte>(write_npy(small))));
  EXPECT_EQ(prepare(DatasetKind::vocaset, raw.path(), out.path()).error().code, Errc::incompatible);
  fs::remove(raw / "raw_audio_fixed.pkl");
  EXPECT_EQ(prepare(DatasetKind::vocaset, raw.path(), out.path()).error().code, Errc::input);
}

// Seven vertices; vertex v of frame n lies at (v, n, 0).
std::string mesh_text(int n) {
  Mesh mesh;
  for (int v = 0; v < 7; ++v) mesh.positions.push_back({static_cast<float>(v), static_cast<float>(n), 0});
  mesh.triangles = {{0, 1, 2}};
  return write_obj(mesh);
}

TEST(PrepareMultiface, LeavesVerticesOutAndScales) {
  const TestFolder raw, out;
  const fs::path tracked = raw.path() / "tracked", neutral = raw.path() / "neutral";
  for (const fs::path& folder : {tracked / "2_46", tracked / "2" / "7", tracked / "3_01", neutral})
    fs::create_directories(folder);
  for (int n = 1; n <= 12; ++n)
    ASSERT_TRUE(write_file(tracked / "2_46" / (std::to_string(n) + ".obj"), mesh_text(n)));
  ASSERT_TRUE(write_file(tracked / "2" / "7" / "000001.obj", mesh_text(1)));
  ASSERT_TRUE(write_file(tracked / "3_01" / "000001.obj", mesh_text(1)));
  ASSERT_TRUE(write_file(neutral / "2.obj", mesh_text(0)));
  ASSERT_TRUE(write_file(raw / "drop.txt", std::string_view("5, 1\n1")));
  tiny::write_sound(raw.path() / "sound" / "2_46.wav", 0.4);
  tiny::write_sound(raw.path() / "sound" / "3_01.wav", 0.1);
  const PrepareOptions options{.templates = neutral, .drop_vertices = raw / "drop.txt"};
  const auto report = prepare(DatasetKind::multiface, raw.path(), out.path(), options);
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->num_sequences, 1);
  EXPECT_EQ(report->num_frames, 12);
  EXPECT_THAT(report.warnings, Contains(HasSubstr("2_7 is left out: no sound")));
  EXPECT_THAT(report.warnings, Contains(HasSubstr("3_01 is left out: no template")));
  const NpyArray motion = array_of(out.path() / "vertices_npy" / "2_46.npy");
  EXPECT_THAT(motion.shape, ElementsAre(12, 15));
  std::vector<float> back(motion.values.begin() + 15 * 9,
                          motion.values.begin() + 15 * 10);  // the tenth, by number
  undo_scale(multiface_scale(), back);
  EXPECT_THAT(back, Pointwise(FloatNear(2e-5f),
                              std::vector<float>{0, 10, 0, 2, 10, 0, 3, 10, 0, 4, 10, 0, 6, 10, 0}));
  const auto before = load_audio(raw.path() / "sound" / "2_46.wav"),
             after = load_audio(out.path() / "wav" / "2_46.wav");
  EXPECT_NEAR(after->samples[100], 10 * before->samples[100], 1e-5);
  EXPECT_THAT(problems(out.path(), DatasetKind::multiface), IsEmpty());

  EXPECT_EQ(prepare(DatasetKind::multiface, raw.path(), out.path()).error().code, Errc::usage);
  ASSERT_TRUE(write_file(raw / "drop.txt", std::string_view("9")));
  EXPECT_THAT(prepare(DatasetKind::multiface, raw.path(), out.path(), options).error().message(),
              HasSubstr("vertex 9 is to be left out"));
  ASSERT_TRUE(write_file(raw / "drop.txt", std::string_view("1 x")));
  EXPECT_EQ(prepare(DatasetKind::multiface, raw.path(), out.path(), options).error().code, Errc::input);
}

// Channel c of frame n is n + c, channel 7 always 3.
void write_uudamm(const fs::path& path, int num_frames) {
  NpyArray controls{{num_frames, 192}, {}};
  for (int n = 0; n < num_frames; ++n)
    for (int c = 0; c < 192; ++c) controls.values.push_back(c == 7 ? 3.0f : static_cast<float>(n + c));
  ASSERT_TRUE(write_file(path, std::span<const std::byte>(write_npy(controls))));
}

TEST(PrepareUudamm, CutsPiecesAndMeasuresRanges) {
  const TestFolder raw, out;
  write_uudamm(raw / "1_b.npy", 2401), write_uudamm(raw / "1_a.npy", 1300),
      write_uudamm(raw / "2_c.npy", 1000);
  write_uudamm(raw / "alone.npy", 8), write_uudamm(raw / "2_mute.npy", 8);
  for (const char* name : {"1_a", "1_b", "2_c"})
    tiny::write_sound(raw.path() / (std::string(name) + ".wav"), 20);
  const auto report = prepare(DatasetKind::uudamm, raw.path(), out.path());
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->num_sequences, 3);  // one of a, two of b, none of c
  EXPECT_THAT(report.warnings, Contains(HasSubstr("alone.npy' is left out")));
  EXPECT_THAT(report.warnings, Contains(HasSubstr("2_mute.npy' is left out: no sound")));
  const NpyArray piece = array_of(out.path() / "vertices_npy" / "1_03.npy");  // the second of b
  EXPECT_THAT(piece.shape, ElementsAre(300, 192));
  // Frames 0, 4 ... 2400 of b have the widest range: 0 ... 2400.
  EXPECT_NEAR(piece.values[0], 1200.0 / 2400 * 2 - 1, 1e-6);
  EXPECT_NEAR(piece.values[192 * 299], (1200.0 + 4 * 299) / 2400 * 2 - 1, 1e-6);
  EXPECT_EQ(piece.values[7], -1) << "a channel that stands still";
  EXPECT_NEAR(load_audio(out.path() / "wav" / "1_03.wav")->seconds(), 10, 1e-9);
  EXPECT_TRUE(fs::exists(out / "scaler.safetensors"));
  EXPECT_THAT(problems(out.path(), DatasetKind::uudamm), IsEmpty());
}

TEST(PrepareUudamm, TakesThePublishedScaler) {
  const TestFolder raw, out;
  write_uudamm(raw / "1_a.npy", 1200);
  tiny::write_sound(raw / "1_a.wav", 10);
  ASSERT_TRUE(
      write_file(raw / "scaler.pkl",
                 std::string_view("csklearn.preprocessing._data\nMinMaxScaler\n)\x81" +
                                  dict({{text("scale_"), array(std::vector<double>(192, 0.5), "f8")},
                                        {text("min_"), array(std::vector<double>(192, -0.25), "f8")}}) +
                                  "b.")));
  const auto report = prepare(DatasetKind::uudamm, raw.path(), out.path(), {.scaler = raw / "scaler.pkl"});
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(array_of(out.path() / "vertices_npy" / "1_01.npy").values[192], 0.5f * 4 - 0.25f);
  EXPECT_FALSE(fs::exists(out / "scaler.safetensors"));
  EXPECT_EQ(prepare(DatasetKind::uudamm, raw.path(), out.path(), {.scaler = raw / "1_a.npy"}).error().code,
            Errc::input);
}

TEST(PrepareMeshes, OfNothingFail) {
  const TestFolder raw, out;
  for (const auto kind : {DatasetKind::vocaset, DatasetKind::uudamm})
    EXPECT_EQ(prepare(kind, raw.path(), out.path()).error().code, Errc::input);
  tiny::write_sound(raw / "2_1.wav", 0.1);
  fs::create_directory(raw / "neutral");
  ASSERT_TRUE(write_file(raw.path() / "neutral" / "2.obj", mesh_text(0)));
  EXPECT_EQ(
      prepare(DatasetKind::multiface, raw.path(), out.path(), {.templates = raw / "neutral"}).error().code,
      Errc::input);
}

}  // namespace
}  // namespace mien
