// Motion of vertices, its measures, and data sets.
#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "mien/audio/load_audio.h"
#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "mien/core/emotion.h"
#include "mien/corpus/corpus_reader.h"
#include "mien/io/character_file.h"
#include "mien/io/mapped_file.h"
#include "mien/io/mesh_file.h"
#include "mien/io/motion_file.h"
#include "mien/io/npy.h"
#include "mien/io/vl.h"
#include "mien/render/png.h"
#include "program.h"
#include "test_paths.h"

namespace mien {
namespace {

using testing::HasSubstr;

constexpr int kSide = 12;  // a square of 144 vertices

// A square that waves: frame n of vertex (x, y) has z = size sin(x + 0.3 n).
Bytes waving_square(int num_frames, double size) {
  NpyArray array{{num_frames, 3 * kSide * kSide}, {}};
  for (int n = 0; n < num_frames; ++n)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        for (const double v : {0.1 * x, 0.1 * y, size * std::sin(x + 0.3 * n)})
          array.values.push_back(static_cast<float>(v));
  return write_npy(array);
}

std::string square_obj() {
  Mesh mesh;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      mesh.positions.push_back({0.1f * static_cast<float>(x), 0.1f * static_cast<float>(y), 0});
      if (x + 1 == kSide || y + 1 == kSide) continue;
      const std::uint32_t v = y * kSide + x;
      mesh.triangles.push_back({v, v + 1, v + kSide});
      mesh.triangles.push_back({v + 1, v + kSide + 1, v + kSide});
    }
  return write_obj(mesh);
}

class SequenceTest : public ProgramTest {
 protected:
  SequenceTest() {
    write("square.obj", square_obj());
    write("wave.npy", as_text(waving_square(10, 0.05)));
  }
};

TEST_F(SequenceTest, VerticesBecomeAFewShapesWithAStatedError) {
  const auto run = mien({"render", "wave.npy", "--mesh", "square.obj", "-o", "wave.glb", "--max-error",
                         "0.05", "--mm-per-unit", "100", "--motion-fps", "30"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("10 frames of 144 vertices in 2 shapes; no vertex is farther than 0.0"));
  const auto character = load_character(in_folder("wave.glb"));
  ASSERT_TRUE(character) << character.error().message();
  ASSERT_EQ(character->parts.size(), 1u);
  EXPECT_EQ(character->parts[0].shapes.size(), 2u);
  EXPECT_THAT(std::string(as_text(bytes_of("wave.glb"))), HasSubstr("\"max_error_mm\":"));
}

TEST_F(SequenceTest, VerticesWithoutTrianglesArePoints) {
  const auto points = mien({"render", "wave.npy", "-o", "points.glb", "--motion-fps", "30"});
  ASSERT_EQ(points.exit_code, 0) << points.err;
  EXPECT_THAT(points.err, HasSubstr("--mesh FILE"));
  const auto picture = mien({"render", "wave.npy", "-o", "wave.png", "--motion-fps", "30"});
  EXPECT_EQ(picture.exit_code, 2);
  EXPECT_THAT(picture.err, HasSubstr("a picture needs triangles"));
  EXPECT_EQ(mien({"render", "wave.npy", "--mesh", "nothing.obj", "-o", "a.glb"}).exit_code, 3);
  write("triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(mien({"render", "wave.npy", "--mesh", "triangle.obj", "-o", "a.glb"}).exit_code, 4);
}

// face + (frame - template), vertex by vertex.
TEST_F(SequenceTest, AnotherFaceMovesInTheMeshsPlace) {
  Mesh other = load_mesh(in_folder("square.obj")).value();
  for (Vec3& p : other.positions) p = {2 * p.x, p.y, 0.1f * p.x + 1};
  write("other.obj", write_obj(other));
  const auto moved = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"render", "wave.npy", "--motion-fps", "30"};
    words.insert(words.end(), more.begin(), more.end());
    return mien(words);
  };
  const auto run = moved({"--mesh", "square.obj", "--face", "other.obj", "-o", "moved.npy"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto got = read_motion(in_folder("moved.npy")), wave = read_motion(in_folder("wave.npy"));
  ASSERT_TRUE(got && wave);
  for (std::size_t v = 0; v < other.positions.size(); ++v) {
    const float x = 0.1f * static_cast<float>(v % kSide);
    EXPECT_NEAR(got->frame(3)[3 * v], 2 * x, 1e-6);
    EXPECT_NEAR(got->frame(3)[3 * v + 2], wave->frame(3)[3 * v + 2] + 0.1f * x + 1, 1e-6);
  }
  // As a modelling program writes it: y into the face, z up.
  for (Vec3& p : other.positions) p = {p.x, -p.z, p.y};
  write("z_up.obj", write_obj(other));
  ASSERT_EQ(
      moved({"--mesh", "square.obj", "--face", "z_up.obj", "--face-z-up", "-o", "turned.npy"}).exit_code, 0);
  EXPECT_EQ(read_motion(in_folder("turned.npy"))->values, got->values);
  EXPECT_EQ(
      moved({"--mesh", "square.obj", "--face", "other.obj", "-o", "moved.png", "--size", "32"}).exit_code, 0);

  EXPECT_EQ(moved({"--mesh", "square.obj", "--face-z-up", "-o", "a.npy"}).exit_code, 2);
  EXPECT_EQ(moved({"--mesh", "square.obj", "--face", "no.obj", "-o", "a.npy"}).exit_code, 3);
  const auto unknown = moved({"--face", "other.obj", "-o", "a.npy"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("--mesh"));
  write("triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(moved({"--mesh", "square.obj", "--face", "triangle.obj", "-o", "a.npy"}).exit_code, 4);
  ASSERT_EQ(animate({"-o", "a.csv"}).exit_code, 0);
  EXPECT_EQ(mien({"render", "a.csv", "--face", "other.obj", "-o", "a.png"}).exit_code, 2);
  EXPECT_EQ(animate({"--face", "other.obj", "-o", "b.csv"}).exit_code, 2);
}

TEST_F(SequenceTest, VerticesAreDrawnAndWrittenFrameByFrame) {
  const std::vector<std::string> common = {"render",       "wave.npy", "--mesh", "square.obj",
                                           "--motion-fps", "30",       "-o"};
  for (const char* output : {"wave.png", "wave.obj/", "wave.vl/", "copy.npy"}) {
    auto words = common;
    words.emplace_back(output);
    const auto run = mien(words);
    ASSERT_EQ(run.exit_code, 0) << output << run.err;
  }
  EXPECT_EQ(bytes_of("copy.npy"), bytes_of("wave.npy"));
  const auto mesh = load_mesh(in_folder("wave.obj") / "frame_000009.obj");
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_EQ(mesh->triangles.size(), 242u);
  const auto frame = read_vl(*read_file(in_folder("wave.vl") / "frame_000009.vl"));
  ASSERT_TRUE(frame);
  EXPECT_EQ(*frame, mesh->positions);
}

TEST_F(SequenceTest, CurvesBecomeVerticesOfTheirCharacter) {
  ASSERT_EQ(animate({"-o", "a.csv"}).exit_code, 0);
  ASSERT_EQ(mien({"render", "a.csv", "-o", "a.npy"}).exit_code, 0);
  const auto facts = nlohmann::json::parse(mien({"inspect", "a.npy", "--json"}).out);
  EXPECT_EQ(facts["space"], "vertices");
  EXPECT_EQ(facts["frames"], 120);
  EXPECT_GT(facts["largest_movement"], 0);
  // The head's own triangles are found by the number of vertices.
  const auto run = mien({"render", "a.npy", "-o", "a.png", "--size", "64"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST_F(SequenceTest, MotionsAreShownSideBySide) {
  ASSERT_EQ(animate({"-o", "a.csv", "-o", "b.csv"}).exit_code, 0);
  const auto run = mien({"render", "a.csv", "b.csv", "-o", "both.png", "--size", "40", "--times", "1"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto picture = read_png(in_folder("both.png"));
  ASSERT_TRUE(picture);
  EXPECT_GE(picture->width(), 80);
  const auto file = mien({"render", "a.csv", "b.csv", "-o", "both.npy"});
  EXPECT_EQ(file.exit_code, 2);
  EXPECT_THAT(file.err, HasSubstr("holds one motion; 2 were given"));
  const auto mixed = mien({"render", "a.csv", "wave.npy", "-o", "both.png"});
  EXPECT_EQ(mixed.exit_code, 4);
  EXPECT_THAT(mixed.err, HasSubstr("moves other things than 'a.csv'"));
}

TEST_F(SequenceTest, HeatMapsShowWhereAFaceMoves) {
  for (const char* statistic : {"mean", "std"}) {
    const auto run = mien({"render", "wave.npy", "wave.npy", "--mesh", "square.obj", "--motion-fps", "30",
                           "--heatmap", statistic, "-o", "heat.png", "--size", "48"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const auto picture = read_png(in_folder("heat.png"));
    ASSERT_TRUE(picture);
    EXPECT_GE(picture->width(), 96);
    EXPECT_GT(picture->height(), 48);
  }
  ASSERT_EQ(animate({"-o", "a.csv"}).exit_code, 0);
  EXPECT_EQ(mien({"render", "a.csv", "--heatmap", "mean", "-o", "heat.png", "--size", "48"}).exit_code, 0);
  EXPECT_THAT(mien({"render", "a.csv", "--heatmap", "max", "-o", "heat.png"}).err,
              HasSubstr("Known: mean, std"));
  EXPECT_EQ(mien({"render", "a.csv", "--heatmap", "std", "-o", "heat.mp4"}).exit_code, 2);
}

TEST_F(SequenceTest, EvaluateComparesSequencesWithTheTruth) {
  write("still.npy", as_text(waving_square(8, 0)));
  write("lve.txt", "0, 1, 2");
  const auto run = mien({"evaluate", "vertices", "wave.npy", "still.npy", "--regions", "lve.txt", "--mesh",
                         "square.obj", "--system", "both", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto table = nlohmann::json::parse(run.out);
  const auto value = [&](const std::string& name) {
    for (const auto& row : table["rows"])
      if (row["name"] == name) return row["values"][0]["value"];
    return nlohmann::json();
  };
  double mean = 0;
  for (int n = 0; n < 8; ++n)
    for (int x = 0; x < kSide; ++x) mean += std::abs(0.05 * std::sin(x + 0.3 * n)) / (8.0 * kSide);
  EXPECT_NEAR(value("MVE").get<double>(), mean, 1e-7);
  EXPECT_NEAR(value("surface distance").get<double>(), mean, 1e-7);  // the truth is a plane
  EXPECT_GT(value("LVE").get<double>(), 0);
  EXPECT_TRUE(value("FDD").is_null());
  EXPECT_THAT(table["rows"][0]["definition"].get<std::string>(), HasSubstr("Euclidean"));
  EXPECT_THAT(mien({"evaluate", "vertices", "wave.npy", "still.npy"}).out, HasSubstr("MVE = "));
  EXPECT_EQ(mien({"evaluate", "vertices", "wave.npy", "nothing.npy"}).exit_code, 3);
  EXPECT_EQ(mien({"evaluate", "vertices", "wave.npy", "still.npy", "--regions", "unknown.txt"}).exit_code, 2);
  EXPECT_EQ(mien({"evaluate", "vertices", "wave.npy", "still.npy", "--system", "facexhubert"}).exit_code, 2);
  EXPECT_EQ(mien({"evaluate", "controls", "wave.npy", "still.npy", "--system", "uudamm"}).exit_code, 4);
}

TEST_F(SequenceTest, DataCheckTellsProblemsByItsExitCode) {
  std::filesystem::create_directories(in_folder("BEAT") / "wav");
  std::filesystem::create_directories(in_folder("BEAT") / "vertices_npy");
  const auto empty = mien({"data", "check", "BEAT"});
  EXPECT_EQ(empty.exit_code, 3);
  EXPECT_THAT(empty.out, HasSubstr("no sequence has both sound and motion"));
  std::filesystem::copy(in_folder("speech.wav"), in_folder("BEAT") / "wav" / "2_8_01.wav");
  const NpyArray motion{{60, 51}, std::vector<float>(60 * 51)};
  ASSERT_TRUE(write_file(in_folder("BEAT") / "vertices_npy" / "2_8_01.npy",
                         std::span<const std::byte>(write_npy(motion))));
  const auto run = mien({"data", "check", "BEAT", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const auto facts = nlohmann::json::parse(run.out);
  EXPECT_EQ(facts["layout"], "beat");
  EXPECT_EQ(facts["sequences"], 1);
  EXPECT_TRUE(facts["problems"].empty());
  EXPECT_EQ(mien({"data", "check", "nowhere"}).exit_code, 3);
  EXPECT_EQ(mien({"data", "check", "BEAT", "--layout", "beta"}).exit_code, 2);
  EXPECT_EQ(mien({"data", "prepare", "BEAT", "--layout", "vocaset", "-o", "out"}).exit_code, 3);
  EXPECT_EQ(mien({"data", "prepare", "BEAT", "--layout", "multiface", "-o", "out"}).exit_code, 2);
}

// Names, rate and columns are those of BEAT (person_emotion_number), and each has its own sound.
TEST_F(SequenceTest, ACorpusBecomesADataSet) {
  const auto corpus = project_path("tests/data/corpus_fixture");
  const auto run =
      mien({"data", "prepare", corpus.string(), "--layout", "beat", "-o", "synthetic", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("\"sequences\":12"));
  const auto facts =
      nlohmann::json::parse(mien({"data", "check", "synthetic", "--read-values", "--json"}).out);
  EXPECT_EQ(facts["layout"], "beat");
  EXPECT_EQ(facts["sequences"], 12);
  EXPECT_TRUE(facts["problems"].empty());
  EXPECT_EQ(facts["oddities"].size(), 1) << facts["oddities"];  // too few items for other splits
  const auto reader = CorpusReader::open(corpus);
  ASSERT_TRUE(reader.has_value());
  const auto names = arkit_order(ArkitOrder::beat);
  const std::map<std::string_view, int> numbers = {{"neutral", 0}, {"happy", 1},    {"angry", 2},
                                                   {"sad", 3},     {"contempt", 4}, {"surprised", 5},
                                                   {"fear", 6},    {"disgusted", 7}};
  std::map<std::string, int> count;
  for (const CorpusItem& item : reader->items()) {
    const std::string kind = item.speaker + "_" + std::to_string(numbers.at(name_of(item.emotion)));
    const std::string name = kind + "_" + std::to_string(++count[kind]);
    SCOPED_TRACE(item.id + " is " + name);
    const auto takes = reader->takes(item, 1);
    ASSERT_TRUE(takes.has_value());
    const Motion& truth = takes->takes.front();
    const auto file = MappedFile::open(in_folder("synthetic") / "vertices_npy" / (name + ".npy"));
    ASSERT_TRUE(file.has_value());
    const auto array = read_npy(file->bytes());
    ASSERT_TRUE(array.has_value());
    ASSERT_EQ(array->shape, (std::vector<std::int64_t>{(item.num_frames + 1) / 2, std::ssize(names)}));
    for (std::int64_t n = 0; n < array->shape[0]; n += 7)
      for (std::size_t c = 0; c < names.size(); ++c)
        ASSERT_EQ(array->values[static_cast<std::size_t>(n) * names.size() + c],
                  truth.frame(2 * n)[arkit_index(names[c])])
            << "frame " << n << " " << names[c];
    const auto sound = load_audio(in_folder("synthetic") / "wav" / (name + ".wav")),
               own = load_audio(reader->audio_path(item));
    ASSERT_TRUE(sound.has_value() && own.has_value());
    EXPECT_EQ(sound->samples, own->samples);
  }
  EXPECT_EQ(mien({"data", "prepare", corpus.string(), "--layout", "vocaset", "-o", "out"}).exit_code, 2);
}

// Takes around the truth: none is right, their mean is.
TEST_F(SequenceTest, TakesAreMeasuredTogether) {
  std::filesystem::create_directories(in_folder("takes"));
  std::filesystem::create_directories(in_folder("true"));
  write("true/a.npy", as_text(waving_square(10, 0.05)));
  write("takes/a_happy(1).npy", as_text(waving_square(10, 0.06)));
  write("takes/a_happy(2).npy", as_text(waving_square(10, 0.04)));
  write("mouth.txt", "0, 1, 2, 13");
  const auto run = mien({"evaluate", "takes", "takes", "true", "--mouth", "mouth.txt", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto table = nlohmann::json::parse(run.out);
  std::map<std::string, double> values;
  for (const auto& row : table.at("rows"))
    if (const auto& value = row.at("values").at(0).at("value"); value.is_number())
      values[row.at("name")] = value.get<double>();
  EXPECT_GT(values.at("LVE"), 1e-5);
  EXPECT_NEAR(values.at("MEE"), 0, 1e-12);
  EXPECT_NEAR(values.at("CE"), values.at("LVE"), 1e-8);
  EXPECT_NEAR(values.at("Diversity"), 2 * values.at("MVE"), 1e-8);
  EXPECT_EQ(mien({"evaluate", "takes", "takes", "true", "--character", "default"}).exit_code, 2)
      << "vertices are not in the character's millimetres";
  const auto parameters = mien({"evaluate", "takes", "takes", "absent"});
  EXPECT_EQ(parameters.exit_code, 3);
}

}  // namespace
}  // namespace mien
