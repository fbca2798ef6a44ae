#include "mien/io/character_file.h"

#include <algorithm>
#include <cmath>

#include "io_test_support.h"
#include "mien/base/file.h"
#include "mien/base/random.h"
#include "mien/core/arkit.h"
#include "mien/io/gltf_reader.h"
#include "mien/io/gltf_writer.h"
#include "mien/io/safetensors.h"

namespace mien {
namespace {

using namespace test;

std::string text_of(const std::vector<std::string>& warnings) {
  std::string text;
  for (const auto& w : warnings) text += w + "\n";
  return text;
}

class SharedFace : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    path_ = shared_file(std::string("faces/") + GetParam() + ".safetensors");
    if (!path_) GTEST_SKIP() << "faces/" << GetParam() << ".safetensors is not here";
  }
  std::optional<std::filesystem::path> path_;
};
INSTANTIATE_TEST_SUITE_P(Faces, SharedFace, testing::ValuesIn(kFaces),
                         [](const auto& face) { return std::string(face.param); });

TEST_P(SharedFace, LoadsInMetres) {
  const auto face = load_character(*path_);
  ASSERT_TRUE(face) << face.error().message();
  ASSERT_EQ(face->parts.size(), 1u);
  float low = 1e9f, high = -1e9f;
  for (const Vec3 p : face->parts[0].mesh.positions) low = std::min(low, p.y), high = std::max(high, p.y);
  // A mask is about 0.15 m high, a bust up to 0.5 m, whatever the unit of the file.
  EXPECT_GT(high - low, 0.1f);
  EXPECT_LT(high - low, 0.7f);
  const std::string warnings = text_of(face.warnings);
  if (std::string(GetParam()) == "makehuman_head") {
    EXPECT_EQ(face->parts[0].shapes.size(), 52u);
    EXPECT_EQ(warnings.find("no shape for"), std::string::npos);
  } else if (std::string(GetParam()) == "mediapipe_canonical") {
    EXPECT_NE(warnings.find("speech will not move"), std::string::npos);
  } else {
    EXPECT_EQ(face->parts[0].shapes.size(), 51u);
    EXPECT_NE(warnings.find("no shape for: tongueOut"), std::string::npos);
    EXPECT_EQ(face->regions.at("landmarks68").size(), 68u);
    EXPECT_FALSE(face->regions.at("lips").empty());
  }
}

TEST_P(SharedFace, SurvivesTheTripThroughGltf) {
  const auto face = load_character(*path_);
  ASSERT_TRUE(face);
  const auto bytes = write_glb(*face);
  ASSERT_TRUE(bytes);
  const auto read = read_glb(*bytes);
  ASSERT_TRUE(read) << read.error().message();
  expect_same(*read, *face);
}

TEST_P(SharedFace, OrderAndSpellingOfNamesDoNotMatter) {
  auto face = load_character(*path_);
  ASSERT_TRUE(face);
  auto& shapes = face->parts[0].shapes;
  if (shapes.empty()) GTEST_SKIP() << "a face without shapes";
  const auto original = shapes;
  Rng rng(7);
  for (std::size_t i = shapes.size(); i > 1; --i) std::swap(shapes[i - 1], shapes[rng.below(i)]);
  for (auto& shape : shapes) {  // eyeBlinkLeft -> blendShape1.eyeBlink_L
    std::string& name = shape.name;
    const bool is_direction =
        name == "jawLeft" || name == "jawRight" || name == "mouthLeft" || name == "mouthRight";
    if (name.ends_with("Left") && !is_direction) name = name.substr(0, name.size() - 4) + "_L";
    if (name.ends_with("Right") && !is_direction) name = name.substr(0, name.size() - 5) + "_R";
    name = "blendShape1." + name;
  }
  std::vector<std::string> lost;
  while (shapes.size() > 40) {
    lost.push_back(std::string(*match_arkit_name(shapes.back().name)));
    shapes.pop_back();
  }
  const auto read = read_glb(*write_glb(*face, {.normals = false}));
  ASSERT_TRUE(read) << read.error().message();
  ASSERT_EQ(read->parts[0].shapes.size(), shapes.size());
  for (const Blendshape& shape : original) {
    const auto found = std::find_if(read->parts[0].shapes.begin(), read->parts[0].shapes.end(),
                                    [&](const Blendshape& s) { return s.name == shape.name; });
    if (std::find(lost.begin(), lost.end(), shape.name) != lost.end()) {
      EXPECT_EQ(found, read->parts[0].shapes.end()) << shape.name;
      EXPECT_NE(text_of(read.warnings).find(shape.name), std::string::npos);
    } else {
      ASSERT_NE(found, read->parts[0].shapes.end()) << shape.name;
      expect_same_shape(*found, shape, GetParam());
    }
  }
}

Metadata metadata(const char* units) { return {{"units", units}, {"name", "test face"}}; }

std::filesystem::path write_face(const Metadata& meta, const std::vector<float>& jaw,
                                 std::int32_t corner = 2) {
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("character_file_test_" + std::to_string(::getpid()) + ".safetensors");
  auto writer = SafetensorsWriter::create(path,
                                          {{"neutral", Dtype::f32, {3, 3}},
                                           {"triangles", Dtype::i32, {1, 3}},
                                           {"shape.jaw_Open", Dtype::f32, {3, 3}},
                                           {"shape.odd", Dtype::f32, {3, 3}},
                                           {"region.lips", Dtype::i32, {2}},
                                           {"identity.000", Dtype::f32, {3, 3}}},
                                          meta);
  EXPECT_TRUE(writer);
  const std::vector<float> zero(9), neutral = {0, 0, 0, 1, 0, 0, 0, 1, 0}, odd = {0, 0, 1, 0, 0, 0, 0, 0, 0};
  EXPECT_TRUE(writer->write("neutral", neutral));
  EXPECT_TRUE(writer->write("triangles", std::vector<std::int32_t>{0, 1, corner}));
  EXPECT_TRUE(writer->write("shape.jaw_Open", jaw));
  EXPECT_TRUE(writer->write("shape.odd", odd));
  EXPECT_TRUE(writer->write("region.lips", std::vector<std::int32_t>{0, 2}));
  EXPECT_TRUE(writer->write("identity.000", zero));
  EXPECT_TRUE(writer->finish());
  return path;
}

TEST(CharacterFile, ReadsUnitsNamesAndRegions) {
  const std::vector<float> jaw = {0, 0, 0, 0, -1, 0, 0, 0, 0};
  for (const auto& [units, size] :
       {std::pair{"metres", 1.0f}, {"centimetres; +y up", 0.01f}, {"mm", 0.001f}}) {
    const auto face = load_character(write_face(metadata(units), jaw));
    ASSERT_TRUE(face) << face.error().message();
    EXPECT_EQ(face->name, "test face");
    EXPECT_FLOAT_EQ(face->parts[0].mesh.positions[1].x, size);
    ASSERT_EQ(face->parts[0].shapes.size(), 2u);
    EXPECT_EQ(face->parts[0].shapes[0].name, "jawOpen");
    EXPECT_FLOAT_EQ(face->parts[0].shapes[0].offsets[0].y, -size);
    EXPECT_EQ(face->regions.at("lips"), (std::vector<std::uint32_t>{0, 2}));
    EXPECT_NE(text_of(face.warnings).find("without an ARKit name: odd"), std::string::npos);
    EXPECT_NE(text_of(face.warnings).find("not used: identity.000"), std::string::npos);
  }
}

TEST(CharacterFile, RefusesWrongUnitsIndicesAndNumbers) {
  const std::vector<float> jaw(9);
  EXPECT_FALSE(load_character(write_face(metadata("parsecs"), jaw)));
  EXPECT_FALSE(load_character(write_face(metadata("m"), jaw, 3)));
  EXPECT_FALSE(load_character(write_face(metadata("m"), jaw, -1)));
  auto broken = jaw;
  broken[4] = NAN;
  EXPECT_FALSE(load_character(write_face(metadata("m"), broken)));
}

TEST(CharacterFile, ChoosesByExtension) {
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("character_file_test_" + std::to_string(::getpid()) + ".GLB");
  ASSERT_TRUE(write_file(path, *write_glb(tiny_character())));
  const auto read = load_character(path);
  ASSERT_TRUE(read) << read.error().message();
  expect_same(*read, tiny_character());
  EXPECT_EQ(load_character("face.obj").error().code, Errc::incompatible);
  EXPECT_EQ(load_character("/nowhere/face.glb").error().code, Errc::input);
}

}  // namespace
}  // namespace mien
