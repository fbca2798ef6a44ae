#include "mien/io/gltf_reader.h"

#include <algorithm>
#include <cmath>

#include "io_test_support.h"
#include "mien/core/arkit.h"
#include "mien/io/gltf_writer.h"

namespace mien {
namespace {

using namespace test;

// One triangle whose accessors can be swapped for other encodings: accessor 0 POSITION, 1 target POSITION.
struct Sample {
  Json json;
  Bytes bin;

  std::size_t add_view(const Bytes& data, std::optional<int> stride = {}) {
    bin.resize((bin.size() + 3) / 4 * 4);
    Json view = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", data.size()}};
    if (stride) view["byteStride"] = *stride;
    bin.insert(bin.end(), data.begin(), data.end());
    json["bufferViews"].push_back(view);
    return json["bufferViews"].size() - 1;
  }
  Bytes glb() {
    json["buffers"] = Json::array({{{"byteLength", bin.size()}}});
    return make_glb(json, bin);
  }
};

template <class T>
Bytes packed(std::initializer_list<T> values) {
  Bytes out;
  for (const T v : values) append_le(out, v);
  return out;
}

Sample sample(const char* target_name = "jawOpen") {
  Sample s;
  s.json = {
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", Json::array({{{"nodes", {0}}}})},
      {"nodes", Json::array({{{"mesh", 0}}})},
      {"meshes", Json::array({{{"primitives", Json::array({{{"attributes", {{"POSITION", 0}}},
                                                            {"targets", Json::array({{{"POSITION", 1}}})}}})},
                               {"extras", {{"targetNames", Json::array({target_name})}}}}})}};
  const auto positions = s.add_view(packed<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}));
  const auto offsets = s.add_view(packed<float>({0, 0, 0, 0, -0.5f, 0, 0, 0, 0}));
  const Json accessor = {{"componentType", 5126}, {"type", "VEC3"}, {"count", 3}};
  s.json["accessors"] = {accessor, accessor};
  s.json["accessors"][0]["bufferView"] = positions;
  s.json["accessors"][1]["bufferView"] = offsets;
  return s;
}

std::string all(const std::vector<std::string>& warnings) {
  std::string text;
  for (const auto& w : warnings) text += w + "\n";
  return text;
}

TEST(GltfReader, ReadsUnindexedTriangles) {
  const auto c = read_glb(sample().glb());
  ASSERT_TRUE(c) << c.error().message();
  ASSERT_EQ(c->parts.size(), 1u);
  EXPECT_EQ(c->parts[0].mesh.positions[1], (Vec3{1, 0, 0}));
  ASSERT_EQ(c->parts[0].mesh.triangles.size(), 1u);
  ASSERT_EQ(c->parts[0].shapes.size(), 1u);
  EXPECT_EQ(c->parts[0].shapes[0].vertices, (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(c->parts[0].shapes[0].offsets[0], (Vec3{0, -0.5f, 0}));
  EXPECT_TRUE(c->parts[0].mesh.normals.empty());
}

TEST(GltfReader, MatchesSpellingsAndReportsBothSides) {
  const auto c = read_glb(sample("blendShape1.jaw_Open").glb());
  ASSERT_TRUE(c);
  EXPECT_EQ(c->parts[0].shapes[0].name, "jawOpen");
  EXPECT_NE(all(c.warnings).find("no morph target for: eyeBlinkLeft"), std::string::npos);
  EXPECT_EQ(all(c.warnings).find("jawOpen"), std::string::npos);

  const auto other = read_glb(sample("nostrilFlare").glb());
  ASSERT_TRUE(other);
  EXPECT_EQ(other->parts[0].shapes[0].name, "nostrilFlare");
  EXPECT_NE(all(other.warnings).find("without an ARKit name: nostrilFlare"), std::string::npos);
  EXPECT_NE(all(other.warnings).find("speech will not move"), std::string::npos);
}

TEST(GltfReader, FindsNamesOnAccessorsAndPrimitives) {
  Sample s = sample();
  s.json["meshes"][0].erase("extras");
  s.json["accessors"][1]["name"] = "JawOpen";
  EXPECT_EQ(read_glb(s.glb())->parts[0].shapes[0].name, "jawOpen");
  s.json["meshes"][0]["primitives"][0]["extras"]["targetNames"] = {"tongueOut"};
  EXPECT_EQ(read_glb(s.glb())->parts[0].shapes[0].name, "tongueOut");
  s.json["meshes"][0]["primitives"][0].erase("extras");
  s.json["accessors"][1].erase("name");
  EXPECT_EQ(read_glb(s.glb())->parts[0].shapes[0].name, "target_0");
}

TEST(GltfReader, AddsTheHalvesOfSymmetricShapes) {
  Sample s = sample();
  s.json["meshes"][0]["extras"]["targetNames"] = {"browInnerUp_L", "browInnerUp_R"};
  s.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 1}}, {{"POSITION", 1}}};
  const auto c = read_glb(s.glb());
  ASSERT_TRUE(c);
  ASSERT_EQ(c->parts[0].shapes.size(), 1u);
  EXPECT_EQ(c->parts[0].shapes[0].name, "browInnerUp");
  EXPECT_EQ(c->parts[0].shapes[0].offsets[0], (Vec3{0, -1, 0}));
  // Doubles that are no halves: the plain spelling wins, the other keeps its name.
  s.json["meshes"][0]["extras"]["targetNames"] = {"jaw_Open", "jawOpen"};
  const auto d = read_glb(s.glb());
  ASSERT_TRUE(d);
  ASSERT_EQ(d->parts[0].shapes.size(), 2u);
  EXPECT_EQ(d->parts[0].shapes[0].name, "jaw_Open");
  EXPECT_EQ(d->parts[0].shapes[1].name, "jawOpen");
}

TEST(GltfReader, BakesDefaultWeightsOfOtherTargetsOnly) {
  Sample s = sample("chubby");
  s.json["meshes"][0]["weights"] = {0.5};
  EXPECT_EQ(read_glb(s.glb())->parts[0].mesh.positions[1], (Vec3{1, -0.25f, 0}));
  s.json["nodes"][0]["weights"] = {1.0};
  EXPECT_EQ(read_glb(s.glb())->parts[0].mesh.positions[1], (Vec3{1, -0.5f, 0}));
  Sample known = sample("jawOpen");
  known.json["meshes"][0]["weights"] = {0.5};
  EXPECT_EQ(read_glb(known.glb())->parts[0].mesh.positions[1], (Vec3{1, 0, 0}));
}

TEST(GltfReader, ReadsSparseTargets) {
  Sample s = sample();
  const auto indices = s.add_view(packed<std::uint16_t>({0, 2}));
  const auto values = s.add_view(packed<float>({0, 1, 0, 0, 0, 2}));
  s.json["accessors"][1] = {{"componentType", 5126},
                            {"type", "VEC3"},
                            {"count", 3},
                            {"sparse",
                             {{"count", 2},
                              {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                              {"values", {{"bufferView", values}}}}}};
  const auto c = read_glb(s.glb());
  ASSERT_TRUE(c) << c.error().message();
  EXPECT_EQ(c->parts[0].shapes[0].vertices, (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(c->parts[0].shapes[0].offsets[1], (Vec3{0, 0, 2}));
  // Sparse rows on top of stored data.
  s.json["accessors"][1]["bufferView"] = 1;
  EXPECT_EQ(read_glb(s.glb())->parts[0].shapes[0].vertices, (std::vector<std::uint32_t>{0, 1, 2}));
  s.json["accessors"][1]["sparse"]["count"] = 3;
  EXPECT_FALSE(read_glb(s.glb()));
  s.json["accessors"][1]["sparse"]["count"] = 0;
  EXPECT_FALSE(read_glb(s.glb()));
}

TEST(GltfReader, RefusesSparseIndicesThatDoNotRise) {
  for (const auto& list :
       {packed<std::uint16_t>({2, 0}), packed<std::uint16_t>({1, 1}), packed<std::uint16_t>({0, 3})}) {
    Sample s = sample();
    const auto indices = s.add_view(list);
    s.json["accessors"][1]["sparse"] = {{"count", 2},
                                        {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                        {"values", {{"bufferView", 0}}}};
    EXPECT_FALSE(read_glb(s.glb()));
  }
}

TEST(GltfReader, ReadsQuantisedAndInterleavedData) {
  Sample s = sample();
  // KHR_mesh_quantization: shorts padded to 8 bytes; a normalised byte target padded to 4.
  const auto positions = s.add_view(packed<std::int16_t>({0, 0, 0, 9, 100, 0, 0, 9, 0, 100, -7, 9}), 8);
  s.json["accessors"][0] = {
      {"bufferView", positions}, {"componentType", 5122}, {"type", "VEC3"}, {"count", 3}};
  const auto offsets = s.add_view(packed<std::int8_t>({0, 0, 0, 9, 0, -128, 127, 9, 0, 0, 0, 9}), 4);
  s.json["accessors"][1] = {
      {"bufferView", offsets}, {"componentType", 5120}, {"normalized", true}, {"type", "VEC3"}, {"count", 3}};
  s.json["nodes"][0]["scale"] = {0.01, 0.01, 0.01};
  const auto c = read_glb(s.glb());
  ASSERT_TRUE(c) << c.error().message();
  EXPECT_EQ(c->parts[0].mesh.positions[1], (Vec3{1, 0, 0}));
  EXPECT_FLOAT_EQ(c->parts[0].mesh.positions[2].z, -0.07f);
  EXPECT_EQ(c->parts[0].shapes[0].offsets[0], (Vec3{0, -0.01f, 0.01f}));

  // Position and colour in one view, 16 bytes a vertex.
  Sample t = sample();
  Bytes mixed;
  for (int v = 0; v < 3; ++v) {
    for (const float x : {static_cast<float>(v), 0.0f, static_cast<float>(v * v)}) append_le(mixed, x);
    for (const int k : {255, 51, 0, 255}) append_le(mixed, static_cast<std::uint8_t>(k));
  }
  const auto view = t.add_view(mixed, 16);
  t.json["accessors"][0]["bufferView"] = view;
  t.json["accessors"].push_back({{"bufferView", view},
                                 {"byteOffset", 12},
                                 {"componentType", 5121},
                                 {"normalized", true},
                                 {"type", "VEC4"},
                                 {"count", 3}});
  t.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 2;
  const auto d = read_glb(t.glb());
  ASSERT_TRUE(d) << d.error().message();
  EXPECT_EQ(d->parts[0].mesh.positions[2], (Vec3{2, 0, 4}));
  EXPECT_FLOAT_EQ(d->parts[0].mesh.colors[2][1], 0.2f);
}

TEST(GltfReader, AppliesNodeTransforms) {
  Sample s = sample();
  // A parent that turns 90 degrees about +z and moves, a child that doubles and mirrors x.
  s.json["nodes"] = {
      {{"children", {1}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}, {"translation", {5, 0, 0}}},
      {{"mesh", 0}, {"scale", {-2, 2, 2}}}};
  const auto normals = s.add_view(packed<float>({0, 0, 1, 0, 0, 1, 1, 0, 0}));
  s.json["accessors"].push_back(
      {{"bufferView", normals}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 3}});
  s.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 2;
  const auto c = read_glb(s.glb());
  ASSERT_TRUE(c) << c.error().message();
  const Mesh& mesh = c->parts[0].mesh;
  const auto near = [](Vec3 a, Vec3 b) { return length(a - b) < 1e-6f; };
  EXPECT_TRUE(near(mesh.positions[1], {5, -2, 0}));
  EXPECT_TRUE(near(mesh.positions[2], {3, 0, 0}));
  EXPECT_TRUE(near(c->parts[0].shapes[0].offsets[0], {1, 0, 0}));
  EXPECT_TRUE(near(mesh.normals[0], {0, 0, 1}));
  EXPECT_TRUE(near(mesh.normals[2], {0, -1, 0}));
  // The mirror turns triangles inside out, so their order is changed back.
  EXPECT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{0, 2, 1}));
}

TEST(GltfReader, AppliesTheRestPoseOfSkins) {
  Sample s = sample();
  s.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}}, {{"translation", {0, 3, 0}}}};
  s.json["scenes"][0]["nodes"] = {0, 1};
  const auto bind = s.add_view(packed<float>({2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, -1, 0, 1}));
  const auto joints = s.add_view(packed<std::uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  const auto weights = s.add_view(packed<float>({1, 0, 0, 0, 0.5f, 0, 0, 0, 1, 0, 0, 0}));
  s.json["accessors"].push_back(
      {{"bufferView", bind}, {"componentType", 5126}, {"type", "MAT4"}, {"count", 1}});
  s.json["accessors"].push_back(
      {{"bufferView", joints}, {"componentType", 5121}, {"type", "VEC4"}, {"count", 3}});
  s.json["accessors"].push_back(
      {{"bufferView", weights}, {"componentType", 5126}, {"type", "VEC4"}, {"count", 3}});
  s.json["skins"] = Json::array({{{"joints", {1}}, {"inverseBindMatrices", 2}}});
  s.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = 3;
  s.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = 4;
  const auto c = read_glb(s.glb());
  ASSERT_TRUE(c) << c.error().message();
  EXPECT_EQ(c->parts[0].mesh.positions[0], (Vec3{0, 2, 0}));
  EXPECT_EQ(c->parts[0].mesh.positions[1], (Vec3{2, 2, 0}));  // weights are brought to a sum of one
  EXPECT_EQ(c->parts[0].shapes[0].offsets[0], (Vec3{0, -1, 0}));
  s.json["skins"][0]["joints"] = {7};
  EXPECT_FALSE(read_glb(s.glb()));
}

TEST(GltfReader, TurnsVrm0HeadsAround) {
  Sample s = sample();
  s.json["extensions"]["VRM"] = {{"specVersion", "0.0"}};
  EXPECT_LT(length(read_glb(s.glb())->parts[0].mesh.positions[1] - Vec3{-1, 0, 0}), 1e-6f);
}

TEST(GltfReader, UnfoldsStripsAndFansAndSkipsLines) {
  Sample s = sample();
  const auto positions = s.add_view(packed<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}));
  s.json["accessors"][0] = {
      {"bufferView", positions}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 4}};
  Json& primitive = s.json["meshes"][0]["primitives"][0];
  primitive.erase("targets");
  primitive["mode"] = 5;
  using T = std::vector<std::array<std::uint32_t, 3>>;
  EXPECT_EQ(read_glb(s.glb())->parts[0].mesh.triangles, (T{{0, 1, 2}, {1, 3, 2}}));
  primitive["mode"] = 6;
  EXPECT_EQ(read_glb(s.glb())->parts[0].mesh.triangles, (T{{1, 2, 0}, {2, 3, 0}}));
  primitive["mode"] = 1;
  const auto lines = read_glb(s.glb());
  ASSERT_FALSE(lines);
  EXPECT_EQ(lines.error().code, Errc::incompatible);
}

TEST(GltfReader, ReadsTextWithDataUris) {
  const Character character = tiny_character();
  Glb glb = open_glb(*write_glb(character));
  // Base64 by hand: 3 bytes to 4 letters.
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  glb.bin.resize((glb.bin.size() + 2) / 3 * 3);
  for (std::size_t i = 0; i < glb.bin.size(); i += 3) {
    const auto word = std::to_integer<unsigned>(glb.bin[i]) << 16 |
                      std::to_integer<unsigned>(glb.bin[i + 1]) << 8 |
                      std::to_integer<unsigned>(glb.bin[i + 2]);
    for (const int shift : {18, 12, 6, 0}) text += alphabet[word >> shift & 63u];
  }
  glb.json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + text;
  const std::string file = glb.json.dump();
  const auto read = read_glb(as_bytes(file));
  ASSERT_TRUE(read) << read.error().message();
  expect_same(*read, character);
  glb.json["buffers"][0]["uri"] = "data:application/octet-stream;base64,A*==";
  EXPECT_FALSE(read_glb(as_bytes(glb.json.dump())));
  glb.json["buffers"][0]["uri"] = "../secret.bin";
  EXPECT_FALSE(read_glb(as_bytes(glb.json.dump())));
}

TEST(GltfReader, RefusesHostileStructure) {
  const auto refused = [](auto change, const char* why) {
    Sample s = sample();
    change(s.json);
    const auto c = read_glb(s.glb());
    EXPECT_FALSE(c) << why;
    EXPECT_TRUE(c || !c.error().why.empty()) << why;
  };
  refused([](Json& j) { j["asset"]["version"] = "1.0"; }, "version");
  refused([](Json& j) { j.erase("asset"); }, "asset");
  refused([](Json& j) { j["nodes"][0]["children"] = {0}; }, "own child");
  refused([](Json& j) { j["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}}; }, "cycle");
  refused(
      [](Json& j) {
        j["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
      },
      "two parents");
  refused([](Json& j) { j["nodes"][0]["children"] = {9}; }, "missing child");
  refused([](Json& j) { j["nodes"][0]["mesh"] = 9; }, "missing mesh");
  refused([](Json& j) { j["nodes"][0]["matrix"] = {1, 2}; }, "short matrix");
  refused([](Json& j) { j["nodes"][0]["scale"] = {1e300, 1e300, 1e300}; }, "far away");
  refused([](Json& j) { j["scene"] = 4; }, "missing scene");
  refused([](Json& j) { j["accessors"][0]["count"] = 4; }, "count beyond the view");
  refused([](Json& j) { j["accessors"][0]["count"] = 1e15; }, "huge count");
  refused([](Json& j) { j["accessors"][0]["count"] = -3; }, "negative count");
  refused([](Json& j) { j["accessors"][0]["type"] = "VEC2"; }, "wrong type");
  refused([](Json& j) { j["accessors"][0]["componentType"] = 5124; }, "unknown component type");
  refused([](Json& j) { j["accessors"][0]["byteOffset"] = 8; }, "offset");
  refused([](Json& j) { j["accessors"][0]["byteOffset"] = 18446744073709551615u; }, "overflowing offset");
  refused([](Json& j) { j["accessors"][1]["count"] = 2; }, "target of another size");
  refused([](Json& j) { j["accessors"][0].erase("bufferView"); }, "positions without data");
  refused([](Json& j) { j["bufferViews"][0]["byteOffset"] = 18446744073709551600u; }, "overflowing view");
  refused([](Json& j) { j["bufferViews"][0]["byteLength"] = 1000; }, "view beyond the buffer");
  refused([](Json& j) { j["bufferViews"][0]["byteStride"] = 4; }, "stride");
  refused([](Json& j) { j["bufferViews"][0]["byteStride"] = 18446744073709551615u; }, "huge stride");
  refused([](Json& j) { j["meshes"][0]["primitives"][0]["indices"] = 0; }, "float indices");
  refused([](Json& j) { j["meshes"][0]["primitives"][0]["attributes"] = 3; }, "no attributes");
  refused(
      [](Json& j) {
        j["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}});
      },
      "primitives with different targets");
  refused([](Json& j) { j["meshes"][0]["primitives"] = Json::array(); }, "no primitives");
}

TEST(GltfReader, RefusesOutOfRangeIndicesAndNumbers) {
  Sample s = sample();
  const auto indices = s.add_view(packed<std::uint16_t>({0, 1, 3}));
  s.json["accessors"].push_back(
      {{"bufferView", indices}, {"componentType", 5123}, {"type", "SCALAR"}, {"count", 3}});
  s.json["meshes"][0]["primitives"][0]["indices"] = 2;
  EXPECT_FALSE(read_glb(s.glb()));
  Sample n = sample();
  const float nan = NAN;
  std::memcpy(n.bin.data() + 4, &nan, 4);
  EXPECT_FALSE(read_glb(n.glb()));
}

TEST(GltfReader, RefusesChunksThatEndOutsideTheFile) {
  const Bytes whole = sample().glb();
  ASSERT_TRUE(read_glb(whole));
  const std::size_t json_size = *read_le<std::uint32_t>(whole, 12);
  const std::size_t bin_header = 20 + json_size;
  const std::uint32_t bin_size = *read_le<std::uint32_t>(whole, bin_header);
  for (const std::uint32_t extra : {4u, 8u, 12u, 0x7fffffffu}) {
    Bytes damaged = whole;
    const std::uint32_t size = bin_size + extra;
    std::memcpy(&damaged[bin_header], &size, 4);
    EXPECT_FALSE(read_glb(damaged)) << extra;
  }
  Bytes other = whole;
  other[4] = std::byte{1};  // the container's version
  EXPECT_FALSE(read_glb(other));
}

TEST(GltfReader, NamesTheCompressionItCannotRead) {
  Sample s = sample();
  s.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = Json::object();
  const auto draco = read_glb(s.glb());
  ASSERT_FALSE(draco);
  EXPECT_EQ(draco.error().code, Errc::incompatible);
  EXPECT_NE(draco.error().message().find("KHR_draco_mesh_compression"), std::string::npos);
  Sample m = sample();
  m.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0}};
  EXPECT_EQ(read_glb(m.glb()).error().code, Errc::incompatible);
}

TEST(GltfReader, SmallFilesCannotAskForMuchMemory) {
  // Many primitives that share one zero-filled target of a large mesh.
  Sample s = sample();
  const std::size_t num = 300000;
  const auto view = s.add_view(Bytes(num * 12));
  s.json["accessors"][0] = {{"bufferView", view}, {"componentType", 5126}, {"type", "VEC3"}, {"count", num}};
  s.json["accessors"][1] = {{"componentType", 5126}, {"type", "VEC3"}, {"count", num}};
  Json& primitives = s.json["meshes"][0]["primitives"];
  while (primitives.size() < 200) primitives.push_back(primitives[0]);
  const auto c = read_glb(s.glb());
  ASSERT_FALSE(c);
  EXPECT_NE(c.error().why.find("50 million"), std::string::npos);
  // Deep nesting.
  std::string deep = R"({"asset":{"version":"2.0"},"extras":)";
  deep += std::string(100000, '[') + std::string(100000, ']') + "}";
  EXPECT_FALSE(read_glb(as_bytes(deep)));
}

TEST(GltfReader, SurvivesTruncationAndFlippedBytes) {
  const Bytes whole = *write_glb(smallest_character(), {.normals = false});
  torture(
      whole, [](const Bytes& bytes) { return read_glb(bytes).has_value(); },
      [](std::size_t) { return false; });
  Sample small = sample();
  const std::string text = [&] {
    Json json = small.json;
    json["buffers"] = Json::array({{{"byteLength", 0}, {"uri", "data:;base64,"}}});
    return json.dump();
  }();
  for (std::size_t n = 0; n < text.size(); ++n) EXPECT_FALSE(read_glb(as_bytes(text.substr(0, n))));
}

TEST(GltfReader, MissingFileIsAnInputError) {
  const auto c = read_glb(std::filesystem::path("/nowhere/face.glb"));
  ASSERT_FALSE(c);
  EXPECT_EQ(c.error().code, Errc::input);
}

}  // namespace
}  // namespace mien
