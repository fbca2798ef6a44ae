#include "mien/io/gltf_writer.h"

#include <cmath>

#include "io_test_support.h"
#include "mien/io/gltf_reader.h"

namespace mien {
namespace {

using namespace test;

TEST(GltfWriter, WritesOneFaceMeshWithSharedTargets) {
  const auto bytes = write_glb(tiny_character());
  ASSERT_TRUE(bytes);
  const Json json = open_glb(*bytes).json;
  ASSERT_EQ(json["nodes"].size(), 3u);
  EXPECT_EQ(json["nodes"][0]["name"], "Head");
  EXPECT_EQ(json["nodes"][0]["children"], Json({1, 2}));
  EXPECT_EQ(json["scenes"][0]["nodes"], Json::array({0}));
  const Json& face = json["meshes"][0];
  EXPECT_EQ(face["name"], "Face");
  ASSERT_EQ(face["primitives"].size(), 2u);
  EXPECT_EQ(face["extras"]["targetNames"], Json({"eyeLookUpLeft", "jawOpen", "mouthClose", "bulge"}));
  for (const Json& primitive : face["primitives"]) {
    EXPECT_EQ(primitive["targets"].size(), 4u);
    for (const Json& target : primitive["targets"]) EXPECT_TRUE(target.contains("NORMAL"));
  }
  EXPECT_EQ(json["meshes"][1]["name"], "Hair");
  EXPECT_FALSE(json["meshes"][1]["primitives"][0].contains("targets"));
}

TEST(GltfWriter, HeadTurnsAboutThePivotAndVerticesStay) {
  const Character character = tiny_character();
  const auto bytes = write_glb(character, {.pivot = {0.01f, -0.065f, 0.3f}});
  ASSERT_TRUE(bytes);
  const Json nodes = open_glb(*bytes).json["nodes"];
  EXPECT_EQ(nodes[0]["translation"][1].get<float>(), -0.065f);
  EXPECT_EQ(nodes[2]["translation"][1].get<float>(), 0.065f);
  const auto read = read_glb(*bytes);
  ASSERT_TRUE(read);
  for (std::size_t p = 0; p < character.parts.size(); ++p)
    EXPECT_EQ(read->parts[p].mesh.positions, character.parts[p].mesh.positions);
  const Json plain = open_glb(*write_glb(character)).json;
  EXPECT_FALSE(plain["nodes"][0].contains("translation"));
}

TEST(GltfWriter, TargetsAreSparseWithTrueBounds) {
  const auto bytes = write_glb(tiny_character());
  ASSERT_TRUE(bytes);
  const Glb glb = open_glb(*bytes);
  const Json& skin = glb.json["meshes"][0]["primitives"][0];
  const Json& jaw = glb.json["accessors"][skin["targets"][1]["POSITION"].get<std::size_t>()];
  EXPECT_FALSE(jaw.contains("bufferView"));
  EXPECT_EQ(jaw["count"], 4);
  EXPECT_EQ(jaw["sparse"]["count"], 2);
  // Two of four vertices stay, so zero is inside the bounds.
  EXPECT_FLOAT_EQ(jaw["min"][1].get<float>(), -0.02f);
  EXPECT_FLOAT_EQ(jaw["max"][1].get<float>(), 0.0f);
  // An untouched target needs one row.
  const Json& eyes = glb.json["accessors"][skin["targets"][0]["POSITION"].get<std::size_t>()];
  EXPECT_EQ(eyes["sparse"]["count"], 1);
  EXPECT_EQ(eyes["max"], Json({0.0, 0.0, 0.0}));
  for (const Json& view : glb.json["bufferViews"]) EXPECT_EQ(view["byteOffset"].get<int>() % 4, 0);
}

TEST(GltfWriter, NormalsAreNeverZero) {
  Character character = tiny_character();
  character.parts[0].mesh.normals = {{0, 0, 0}, {0, 0, 2}, {NAN, 0, 0}, {1e-25f, 0, 0}};
  const auto read = read_glb(*write_glb(character));
  ASSERT_TRUE(read);
  for (const Vec3 n : read->parts[0].mesh.normals) EXPECT_NEAR(length(n), 1.0f, 1e-5f);
  EXPECT_EQ(read->parts[0].mesh.normals[1], (Vec3{0, 0, 1}));
}

TEST(GltfWriter, NormalTargetsFollowTheSurface) {
  const Character character = tiny_character();
  const auto read = read_glb(*write_glb(character));
  ASSERT_TRUE(read);
  const CharacterPart& skin = read->parts[0];
  std::vector<Vec3> moved = character.parts[0].mesh.positions;
  for (std::size_t r = 0; r < 2; ++r) moved[r] += character.parts[0].shapes[0].offsets[r];
  const auto expected = vertex_normals(moved, skin.mesh.triangles);
  std::vector<Vec3> got = skin.mesh.normals;
  const Blendshape& jaw = skin.shapes[0];
  ASSERT_EQ(jaw.name, "jawOpen");
  ASSERT_EQ(jaw.normal_offsets.size(), jaw.vertices.size());
  for (std::size_t r = 0; r < jaw.vertices.size(); ++r) got[jaw.vertices[r]] += jaw.normal_offsets[r];
  for (std::size_t v = 0; v < got.size(); ++v) EXPECT_NEAR(length(got[v] - expected[v]), 0, 2e-3) << v;
  EXPECT_GT(length(jaw.normal_offsets[0]), 0.01f);

  const auto plain = read_glb(*write_glb(character, {.normals = false}));
  ASSERT_TRUE(plain);
  EXPECT_TRUE(plain->parts[0].shapes[0].normal_offsets.empty());
}

TEST(GltfWriter, SameCharacterSameBytes) {
  EXPECT_EQ(*write_glb(tiny_character()), *write_glb(tiny_character()));
}

TEST(GltfWriter, RoundTripKeepsEverything) {
  const auto read = read_glb(*write_glb(tiny_character()));
  ASSERT_TRUE(read);
  expect_same(*read, tiny_character());
}

TEST(GltfWriter, RefusesBrokenCharacters) {
  const auto broken = [](auto change) {
    Character c = tiny_character();
    change(c);
    EXPECT_THROW((void)write_glb(c), std::logic_error);
  };
  broken([](Character& c) { c.parts.clear(); });
  broken([](Character& c) { c.parts[1].mesh.positions.clear(); });
  broken([](Character& c) { c.parts[1].mesh.triangles[0][2] = 3; });
  broken([](Character& c) { c.parts[0].mesh.normals.pop_back(); });
  broken([](Character& c) { c.parts[0].mesh.colors.pop_back(); });
  broken([](Character& c) { c.parts[0].mesh.positions[1].y = NAN; });
  broken([](Character& c) { c.parts[0].shapes[0].vertices = {1, 0}; });
  broken([](Character& c) { c.parts[0].shapes[0].vertices = {0, 4}; });
  broken([](Character& c) { c.parts[0].shapes[0].offsets.pop_back(); });
  broken([](Character& c) { c.parts[0].shapes[0].offsets[0].x = INFINITY; });
  broken([](Character& c) { c.parts[0].shapes[0].normal_offsets.resize(1); });
  broken([](Character& c) { c.parts[0].shapes[1].name = "jawOpen"; });
  broken([](Character& c) { c.regions["lips"] = {4}; });
}

TEST(GltfWriter, CharacterWithoutShapesHasNoFaceMesh) {
  Character c;
  c.parts = {tiny_character().parts[1]};
  const auto bytes = write_glb(c);
  ASSERT_TRUE(bytes);
  const Json json = open_glb(*bytes).json;
  ASSERT_EQ(json["meshes"].size(), 1u);
  EXPECT_EQ(json["meshes"][0]["name"], "Hair");
  const auto read = read_glb(*bytes);
  ASSERT_TRUE(read);
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_NE(read.warnings[0].find("speech will not move"), std::string::npos);
}

TEST(GltfWriter, IndexWidthsFitTheVertexCount) {
  // 65536 vertices: 16-bit sparse rows, 32-bit triangles (65535 would mean "restart").
  for (const std::size_t num : {255u, 256u, 65535u, 65536u, 65537u}) {
    Character c;
    CharacterPart part;
    part.name = "skin";
    for (std::size_t v = 0; v < num; ++v) part.mesh.positions.push_back({static_cast<float>(v), 0, 0});
    const auto last = static_cast<std::uint32_t>(num - 1);
    part.mesh.triangles = {{0, 1, last}};
    part.shapes = {{"jawOpen", {0, last}, {{0, 1, 0}, {0, 2, 0}}, {}}};
    c.parts = {part};
    const auto bytes = write_glb(c);
    ASSERT_TRUE(bytes);
    const Json json = open_glb(*bytes).json;
    const Json& primitive = json["meshes"][0]["primitives"][0];
    const auto accessor = [&](const Json& index) { return json["accessors"][index.get<std::size_t>()]; };
    EXPECT_EQ(accessor(primitive["indices"])["componentType"], num <= 255     ? 5121
                                                               : num <= 65535 ? 5123
                                                                              : 5125);
    EXPECT_EQ(accessor(primitive["targets"][0]["POSITION"])["sparse"]["indices"]["componentType"],
              num <= 65536 ? 5123 : 5125);
    const auto read = read_glb(*bytes);
    ASSERT_TRUE(read);
    expect_same(*read, c);
  }
}

}  // namespace
}  // namespace mien
