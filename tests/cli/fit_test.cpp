// mien transfer and mien fit: shapes for another mesh, and coefficients back from its vertices.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "mien/base/file.h"
#include "mien/io/character_file.h"
#include "mien/io/gltf_writer.h"
#include "mien/io/mesh_file.h"
#include "mien/io/motion_file.h"
#include "mien/io/npy.h"
#include "pickle_text.h"
#include "program.h"
#include "sheet_face.h"

namespace mien {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Lt;

std::string sheet_obj(int columns, int rows, double jaw = 0, double smile = 0) {
  return write_obj(sheet_mesh(columns, rows, jaw, smile));
}

class FitTest : public ProgramTest {
 protected:
  FitTest() {
    std::filesystem::create_directories(in_folder("shapes"));
    write("shapes/Neutral.obj", sheet_obj(11, 11));
    write("shapes/jawOpen.obj", sheet_obj(11, 11, 0.3));
    write("shapes/mouthSmileLeft.obj", sheet_obj(11, 11, 0, 0.3));
    write("target.obj", sheet_obj(17, 15));
    write("pairs.csv", "source,target\n0,0\n10,16\n110,238\n120,254\n60,127\n");
  }
  [[nodiscard]] Outcome transfer(std::vector<std::string> more = {}) const {
    std::vector<std::string> words = {"transfer",  "target.obj", "--from", "shapes",
                                      "--markers", "pairs.csv",  "-o",     "made.glb"};
    words.insert(words.end(), more.begin(), more.end());
    return mien(words);
  }
  // Half a second at 60 fps.
  [[nodiscard]] static Motion curves() {
    Motion motion{MotionSpace::arkit, {"jawOpen", "mouthSmileLeft"}, 60, {}};
    for (int n = 0; n < 30; ++n)
      for (const double phase : {0.0, 1.5})
        motion.values.push_back(static_cast<float>(0.4 + 0.3 * std::sin(0.15 * n + phase)));
    return motion;
  }
};

TEST_F(FitTest, ShapesOfAnotherMeshComeBackAsCoefficients) {
  const auto made = transfer({"--json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto report = nlohmann::json::parse(made.out);
  EXPECT_EQ(report.at("triangles_with_partner"), report.at("triangles"));
  EXPECT_NEAR(report.at("shapes").at(0).at("target_mm").get<double>(), 30, 3);
  const auto character = load_character(in_folder("made.glb"));
  ASSERT_TRUE(character) << character.error().message();
  ASSERT_EQ(character->parts.at(0).shapes.size(), 2u);

  ASSERT_TRUE(write_motion(in_folder("curves.json"), curves()));
  ASSERT_EQ(mien({"render", "curves.json", "--character", "made.glb", "-o", "moved.npy"}).exit_code, 0);
  const auto fit = mien({"fit", "moved.npy", "--character", "made.glb", "--fps", "60", "-o", "back.json",
                         "--residuals", "left.csv", "--json"});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_LT(nlohmann::json::parse(fit.out).at("residual").at("all").at("max_mm").get<double>(), 1e-3);
  const auto back = read_motion(in_folder("back.json"));
  ASSERT_TRUE(back) << back.error().message();
  const Motion truth = curves();
  ASSERT_EQ(back->values.size(), truth.values.size());
  for (std::size_t i = 0; i < truth.values.size(); ++i) EXPECT_NEAR(back->values[i], truth.values[i], 1e-3);
  EXPECT_THAT(as_text(bytes_of("left.csv")), HasSubstr("sequence,frame,all_mm\nmoved,0,0.00"));
}

TEST_F(FitTest, AFolderOfSequencesIsFittedOnceWithASubsetOfVertices) {
  ASSERT_EQ(transfer().exit_code, 0);
  ASSERT_TRUE(write_motion(in_folder("curves.json"), curves()));
  std::filesystem::create_directories(in_folder("many"));
  for (const char* name : {"many/a.npy", "many/b.obj/"})
    ASSERT_EQ(mien({"render", "curves.json", "--character", "made.glb", "-o", name}).exit_code, 0);
  write("some.txt", "20-200\n");
  const std::vector<std::string> words = {"fit",      "many",    "--character", "made.glb", "--fps", "30",
                                          "--shapes", "jawOpen", "--vertices",  "some.txt", "-o",    "out/"};
  const auto first = mien(words);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("60 frames"));  // 30 frames at 30 fps are read at 60
  for (const char* name : {"out/a.csv", "out/b.csv"}) EXPECT_TRUE(std::filesystem::exists(in_folder(name)));
  const auto again = mien(words);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.err, HasSubstr("2 of 2 outputs are there already"));
  EXPECT_TRUE(again.out.empty());
}

// The optimum of a jump is known: a ramp as steep as is allowed, half of it on either side (the sum of what
// is left over is 0 along it). SAiD, paper section 3.2: at most 0.1 a frame, from 0 to 1.
TEST_F(FitTest, RateLimitsAndUnitsAreThoseOfTheCommand) {
  const Mesh neutral = sheet_mesh(11, 11), open = sheet_mesh(11, 11, 0.3);
  double square = 0;  // of an offset, mean
  for (std::size_t v = 0; v < neutral.positions.size(); ++v)
    square += std::pow(static_cast<double>(open.positions[v].z - neutral.positions[v].z), 2) / 121;
  const auto sequence = [&](const std::string& name, double unit, const auto& jaw) {
    NpyArray frames{{20, 121, 3}, {}};
    for (int n = 0; n < 20; ++n)
      for (std::size_t v = 0; v < neutral.positions.size(); ++v) {
        const Vec3 rest = neutral.positions[v], moved = open.positions[v];
        for (const auto& [from, to] : {std::pair{rest.x, moved.x}, {rest.y, moved.y}, {rest.z, moved.z}})
          frames.values.push_back(static_cast<float>((from + jaw(n) * (to - from)) / unit));
      }
    const Bytes npy = write_npy(frames);
    ASSERT_TRUE(write_file(in_folder(name), std::span<const std::byte>(npy)));
  };
  const auto fitted = [&](const std::string& name, const std::string& face,
                          std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"fit",     name,    "--character", face, "--shapes",
                                      "jawOpen", "--fps", "60",          "-o", "x.json"};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = mien(words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const auto motion = read_motion(in_folder("x.json"));
    EXPECT_TRUE(motion) << motion.error().message();
    return motion ? motion->values : std::vector<float>();
  };
  const auto ramp = [](double most) {
    std::vector<float> values;
    for (int n = 0; n < 20; ++n)
      values.push_back(static_cast<float>(std::clamp(0.4 + most * (n - 9.5), 0.0, 0.8)));
    return testing::Pointwise(testing::FloatNear(1e-5f), values);
  };
  const auto jump = [](int n) { return n < 10 ? 0.0 : 0.8; };
  sequence("jump.npy", 1, jump);
  EXPECT_THAT(fitted("jump.npy", "shapes", {"--residuals", "left.csv"}), ramp(0.1));
  const std::string left(as_text(bytes_of("left.csv")));
  const auto at = left.find("jump,9,");  // 0.35 of the shape
  ASSERT_NE(at, std::string::npos) << left;
  EXPECT_NEAR(std::stod(left.substr(at + 7)), 350 * std::sqrt(square), 0.01);
  EXPECT_THAT(fitted("jump.npy", "shapes", {"--max-change", "0.2"}), ramp(0.2));
  sequence("over.npy", 1, [](int) { return 1.4; });
  EXPECT_THAT(fitted("over.npy", "shapes"), Each(testing::FloatNear(1, 1e-5f)));
  sequence("under.npy", 1, [](int) { return -0.4; });
  EXPECT_THAT(fitted("under.npy", "shapes"), Each(testing::FloatNear(0, 1e-5f)));
  // A character's file is in metres, whatever the sequence is in.
  const Character face = sheet_face(11, 11);
  const auto glb = write_glb(face, {.normals = true, .pivot = {}, .extras = {}});
  ASSERT_TRUE(glb) << glb.error().message();
  ASSERT_TRUE(write_file(in_folder("face.glb"), std::span<const std::byte>(*glb)));
  sequence("in_mm.npy", 1e-3, jump);
  EXPECT_THAT(fitted("in_mm.npy", "face.glb", {"--mm-per-unit", "1"}), ramp(0.1));
}

// As BlendVOCA: persons with faces of their own, of which the residuals move some vertices.
TEST_F(FitTest, PersonsHaveShapesOfTheirOwn) {
  using pickle_text::dict, pickle_text::text;
  constexpr std::size_t kVertices = 120, kMoved = 118;  // the first two are left out
  const auto neutral = [](double person) {
    std::vector<double> values;
    for (std::size_t i = 0; i < 3 * kVertices; ++i)
      values.push_back(0.1 * std::sin(static_cast<double>(i)) + person);
    return values;
  };
  const auto residual = [](double phase) {
    std::vector<double> values;
    for (std::size_t i = 0; i < 3 * kMoved; ++i)
      values.push_back(0.02 * std::cos(1.7 * static_cast<double>(i) + phase));
    return values;
  };
  const auto as_mesh = [](const std::vector<double>& values) {
    return pickle_text::array(values, "f8", {values.size() / 3, 3});
  };
  std::vector<std::pair<std::string, std::string>> templates, residuals;
  std::filesystem::create_directories(in_folder("many"));
  const Motion truth = curves();
  for (const auto& [person, where] : {std::pair{"Anna", 0.0}, {"Bert", 0.5}}) {
    templates.emplace_back(text(person), as_mesh(neutral(where)));
    residuals.emplace_back(text(person), dict({{text("jawOpen"), as_mesh(residual(where))},
                                               {text("mouthSmileLeft"), as_mesh(residual(where + 2))}}));
    NpyArray frames{{truth.num_frames(), kVertices, 3}, {}};
    for (std::int64_t n = 0; n < truth.num_frames(); ++n)
      for (std::size_t i = 0; i < 3 * kVertices; ++i) {
        double value = neutral(where)[i];
        if (i >= 6)
          value += static_cast<double>(truth.frame(n)[0]) * residual(where)[i - 6] +
                   static_cast<double>(truth.frame(n)[1]) * residual(where + 2)[i - 6];
        frames.values.push_back(static_cast<float>(value));
      }
    const Bytes npy = write_npy(frames);
    ASSERT_TRUE(write_file(in_folder("many/" + std::string(person) + "_sentence03.npy"),
                           std::span<const std::byte>(npy)));
  }
  write("templates.pkl", dict(templates) + ".");
  write("residuals.pkl", dict(residuals) + ".");
  write("head.txt", "2-119\n");
  const std::vector<std::string> words = {"fit",
                                          "many",
                                          "--person-shapes",
                                          "residuals.pkl",
                                          "--templates",
                                          "templates.pkl",
                                          "--vertices",
                                          "head.txt",
                                          "--fps",
                                          "60",
                                          "--format",
                                          ".json",
                                          "-o",
                                          "out/"};
  const auto run = mien(words);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* person : {"Anna", "Bert"}) {
    const auto back = read_motion(in_folder("out/" + std::string(person) + "/sentence03.json"));
    ASSERT_TRUE(back) << back.error().message();
    EXPECT_EQ(back->channels, truth.channels);
    ASSERT_EQ(back->values.size(), truth.values.size());
    for (std::size_t i = 0; i < truth.values.size(); ++i)
      EXPECT_NEAR(back->values[i], truth.values[i], 1e-3) << person;
  }
  const auto fails = [](const Outcome& failed, int code, const std::string& why) {
    EXPECT_EQ(failed.exit_code, code) << failed.err;
    EXPECT_THAT(failed.err, HasSubstr(why));
  };
  fails(mien({"fit", "many", "--person-shapes", "residuals.pkl", "-o", "x/"}), 2, "belong together");
  fails(mien({"fit", "many", "--person-shapes", "residuals.pkl", "--templates", "templates.pkl", "-o", "x/"}),
        4, "moves 118 vertices, the templates have 120");
  ASSERT_TRUE(write_file(in_folder("many/Carl_sentence01.npy"), bytes_of("many/Anna_sentence03.npy")));
  fails(mien(words), 4, "is of none of the 2 persons");
  ASSERT_TRUE(write_file(in_folder("many/data_verts.npy"), bytes_of("many/Anna_sentence03.npy")));
  fails(mien(words), 4, "mien data prepare");
}

TEST_F(FitTest, SaysWhatDoesNotFit) {
  const auto expect = [](const Outcome& run, int code, const std::string& words) {
    EXPECT_EQ(run.exit_code, code) << run.err;
    EXPECT_THAT(run.err, HasSubstr(words));
  };
  expect(mien({"transfer", "target.obj", "--from", "shapes", "-o", "made.glb"}), 2,
         "has no landmarks of its own");
  expect(transfer({"--exclude", "0-999"}), 3, "vertex 999 does not exist: there are 255");
  expect(mien({"transfer", "target.obj", "--from", "shapes", "--markers", "pairs.csv", "-o", "made.csv"}), 2,
         "a character is written as .glb");
  write("beyond.csv", "0,0\n10,16\n110,238\n120,255\n60,127\n");
  expect(mien({"transfer", "target.obj", "--from", "shapes", "--markers", "beyond.csv", "-o", "made.glb"}), 3,
         "marker 4: its target vertex 255 does not exist: there are 255");
  write("twice.csv", "0,0\n0,1\n5,5\n9,9\n");
  expect(mien({"transfer", "target.obj", "--from", "shapes", "--markers", "twice.csv", "-o", "made.glb"}), 3,
         "names the source vertex 0 again");
  ASSERT_EQ(transfer().exit_code, 0);
  ASSERT_TRUE(write_motion(in_folder("curves.json"), curves()));
  expect(mien({"fit", "curves.json", "--character", "made.glb", "-o", "x.csv"}), 4,
         "is not motion of vertices");
  expect(mien({"fit", "shapes", "--character", "made.glb", "-o", "x.csv"}), 4, "has 121 vertices");
  expect(mien({"fit", "shapes", "--character", "shapes", "--shapes", "jawOpn", "-o", "x.csv"}), 2,
         "Did you mean jawOpen?");
  expect(mien({"fit", "nothing.npy", "--character", "shapes", "-o", "x.csv"}), 3, "nothing.npy");
  std::filesystem::create_directories(in_folder("empty"));
  expect(mien({"fit", "empty", "--character", "shapes", "-o", "x.csv"}), 3, "holds no sequence");
}

}  // namespace
}  // namespace mien
