// The file that ships: head.glb against the rules of glTF 2.0, and against the head it was made from.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "built_head.h"
#include "mien/base/bytes.h"
#include "mien/base/file.h"
#include "mien/face/pose.h"
#include "mien/io/gltf_reader.h"
#include "test_paths.h"

namespace mien {
namespace {

using Json = nlohmann::json;

struct Glb {
  Json json;
  std::vector<std::byte> bin;
};

// Splits the container, checking its framing.
Glb open_head() {
  const auto file = read_file(built_path("share/mien/head.glb"));
  EXPECT_TRUE(file) << "build the target mien_head_file";
  const Bytes& bytes = *file;
  const auto word = [&](std::size_t offset) { return *read_le<std::uint32_t>(bytes, offset); };
  EXPECT_EQ(word(0), 0x46546C67U);
  EXPECT_EQ(word(4), 2U);
  EXPECT_EQ(word(8), bytes.size());
  const std::size_t json_size = word(12);
  EXPECT_EQ(word(16), 0x4E4F534AU);
  EXPECT_EQ(json_size % 4, 0U);
  const std::size_t bin = 20 + json_size;
  EXPECT_EQ(word(bin + 4), 0x004E4942U);
  EXPECT_EQ(word(bin) % 4, 0U);
  EXPECT_EQ(bin + 8 + word(bin), bytes.size());
  Glb glb;
  glb.json = Json::parse(as_text(std::span(bytes).subspan(20, json_size)));
  glb.bin.assign(bytes.begin() + static_cast<std::ptrdiff_t>(bin + 8), bytes.end());
  return glb;
}

const Glb& head_glb() {
  static const Glb glb = open_head();
  return glb;
}

std::size_t component_size(int type) { return type == 5121 ? 1 : type == 5123 ? 2 : 4; }

std::size_t num_components(const std::string& type) { return type == "SCALAR" ? 1 : type == "VEC4" ? 4 : 3; }

// Offset into the binary chunk of `count` packed elements, after checking that they fit and are aligned.
std::size_t checked_offset(const Json& view_index, std::size_t inner, std::size_t count, std::size_t element,
                           std::size_t component) {
  const Json& view = head_glb().json["bufferViews"].at(view_index.get<std::size_t>());
  const std::size_t offset = view.value("byteOffset", std::size_t{0}) + inner;
  const std::size_t stride = view.value("byteStride", element);
  EXPECT_EQ(offset % component, 0U);
  EXPECT_LE(inner + (count - 1) * stride + element, view["byteLength"].get<std::size_t>());
  EXPECT_LE(offset + (count - 1) * stride + element, head_glb().bin.size());
  return offset;
}

// All values of a float VEC3 accessor, sparse or dense; checks the sparse rules.
std::vector<Vec3> read_vec3(const Json& accessor) {
  const std::size_t count = accessor["count"];
  EXPECT_EQ(accessor["type"], "VEC3");
  EXPECT_EQ(accessor["componentType"], 5126);
  std::vector<Vec3> out(count);
  const auto copy = [](std::size_t offset, std::vector<Vec3>& into) {
    std::memcpy(into.data(), head_glb().bin.data() + offset, into.size() * sizeof(Vec3));
  };
  if (accessor.contains("bufferView"))
    copy(checked_offset(accessor["bufferView"], accessor.value("byteOffset", std::size_t{0}), count, 12, 4),
         out);
  if (!accessor.contains("sparse")) return out;
  const Json& sparse = accessor["sparse"];
  const std::size_t rows = sparse["count"];
  EXPECT_GE(rows, 1U);
  EXPECT_LE(rows, count);
  const Json& indices = sparse["indices"];
  const std::size_t width = component_size(indices["componentType"]);
  const std::size_t at =
      checked_offset(indices["bufferView"], indices.value("byteOffset", std::size_t{0}), rows, width, width);
  std::vector<Vec3> values(rows);
  copy(checked_offset(sparse["values"]["bufferView"], sparse["values"].value("byteOffset", std::size_t{0}),
                      rows, 12, 4),
       values);
  std::int64_t last = -1;
  for (std::size_t r = 0; r < rows; ++r) {
    std::uint32_t index = 0;
    std::memcpy(&index, head_glb().bin.data() + at + r * width, width);
    EXPECT_GT(static_cast<std::int64_t>(index), last);
    EXPECT_LT(index, count);
    last = index;
    out.at(index) = values[r];
  }
  return out;
}

void expect_true_bounds(const Json& accessor, const std::vector<Vec3>& values) {
  std::array<float, 3> low{1e9f, 1e9f, 1e9f}, high{-1e9f, -1e9f, -1e9f};
  for (const Vec3& v : values) {
    const std::array<float, 3> c{v.x, v.y, v.z};
    for (std::size_t i = 0; i < 3; ++i) low[i] = std::min(low[i], c[i]), high[i] = std::max(high[i], c[i]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(accessor["min"][i].get<float>(), low[i]);
    EXPECT_EQ(accessor["max"][i].get<float>(), high[i]);
  }
}

TEST(HeadFile, PrimitivesKeepTheRules) {
  const Json& json = head_glb().json;
  EXPECT_EQ(json["asset"]["version"], "2.0");
  std::size_t num_triangles = 0;
  for (const Json& mesh : json["meshes"])
    for (const Json& primitive : mesh["primitives"]) {
      const auto accessor = [&](const Json& index) { return json["accessors"].at(index.get<std::size_t>()); };
      const Json position = accessor(primitive["attributes"]["POSITION"]);
      const std::size_t count = position["count"];
      expect_true_bounds(position, read_vec3(position));
      const Json normal = accessor(primitive["attributes"]["NORMAL"]);
      ASSERT_EQ(normal["count"], count);
      for (const Vec3& n : read_vec3(normal)) ASSERT_NEAR(length(n), 1, 5e-4);
      const Json color = accessor(primitive["attributes"]["COLOR_0"]);
      EXPECT_EQ(color["count"], count);
      EXPECT_EQ(color["componentType"], 5123);
      EXPECT_EQ(color["normalized"], true);
      checked_offset(color["bufferView"], color.value("byteOffset", std::size_t{0}), count,
                     2 * num_components(color["type"]), 2);
      const Json indices = accessor(primitive["indices"]);
      const std::size_t width = component_size(indices["componentType"]), num_indices = indices["count"];
      EXPECT_EQ(num_indices % 3, 0U);
      num_triangles += num_indices / 3;
      const std::size_t at = checked_offset(
          indices["bufferView"], indices.value("byteOffset", std::size_t{0}), num_indices, width, width);
      for (std::size_t i = 0; i < num_indices; ++i) {
        std::uint32_t index = 0;
        std::memcpy(&index, head_glb().bin.data() + at + i * width, width);
        ASSERT_LT(index, count);
      }
    }
  std::size_t num_made = 0;
  for (const auto& part : test::built_head().character.parts) num_made += part.mesh.triangles.size();
  EXPECT_EQ(num_triangles, num_made);
}

TEST(HeadFile, FaceHasAll52TargetsInEveryPrimitive) {
  const Json& json = head_glb().json;
  const Json& face = json["meshes"][0];
  EXPECT_EQ(face["name"], "Face");
  const std::vector<std::string> names = face["extras"]["targetNames"];
  EXPECT_TRUE(std::equal(names.begin(), names.end(), arkit_names().begin(), arkit_names().end()));
  EXPECT_EQ(face["weights"].size(), kNumArkit);
  for (const Json& primitive : face["primitives"]) {
    ASSERT_EQ(primitive["targets"].size(), kNumArkit);
    const auto& base = json["accessors"].at(primitive["attributes"]["POSITION"].get<std::size_t>());
    for (const Json& target : primitive["targets"]) {
      const Json& position = json["accessors"].at(target["POSITION"].get<std::size_t>());
      EXPECT_EQ(position["count"], base["count"]);
      expect_true_bounds(position, read_vec3(position));
      const Json& normal = json["accessors"].at(target["NORMAL"].get<std::size_t>());
      EXPECT_EQ(normal["count"], base["count"]);
      for (const Vec3& d : read_vec3(normal)) ASSERT_LE(length(d), 2.001f);
    }
  }
}

TEST(HeadFile, ReadsBackAsTheHeadItWasMadeFrom) {
  const auto read = read_glb(built_path("share/mien/head.glb"));
  ASSERT_TRUE(read) << read.error().message();
  const Character& made = test::built_head().character;
  ASSERT_EQ(read->parts.size(), made.parts.size());
  EXPECT_EQ(read->regions, made.regions);
  for (std::size_t p = 0; p < made.parts.size(); ++p) {
    SCOPED_TRACE(made.parts[p].name);
    EXPECT_EQ(read->parts[p].name, made.parts[p].name);
    EXPECT_EQ(read->parts[p].mesh.positions, made.parts[p].mesh.positions);
    EXPECT_EQ(read->parts[p].mesh.triangles, made.parts[p].mesh.triangles);
    // Shapes without vertices are not read back.
    std::vector<const Blendshape*> shapes;
    for (const Blendshape& shape : made.parts[p].shapes)
      if (!shape.vertices.empty()) shapes.push_back(&shape);
    ASSERT_EQ(read->parts[p].shapes.size(), shapes.size());
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      EXPECT_EQ(read->parts[p].shapes[k].name, shapes[k]->name);
      EXPECT_EQ(read->parts[p].shapes[k].vertices, shapes[k]->vertices);
      EXPECT_EQ(read->parts[p].shapes[k].offsets, shapes[k]->offsets);
    }
  }
}

TEST(HeadFile, HeadNodeTurnsAboutTheNeck) {
  const Json& nodes = head_glb().json["nodes"];
  EXPECT_EQ(nodes[0]["name"], "Head");
  const Vec3 pivot = neck_pivot(test::built_head().character);
  const std::vector<float> translation = nodes[0]["translation"];
  EXPECT_EQ(translation, (std::vector<float>{pivot.x, pivot.y, pivot.z}));
}

TEST(HeadFile, TablesNameTheVerticesOfTheSkin) {
  const auto text = read_file(built_path("share/mien/head.json"));
  ASSERT_TRUE(text);
  const Json tables = Json::parse(as_text(*text));
  EXPECT_EQ(tables["mirror"].get<std::vector<std::uint32_t>>(), test::built_head().mirror);
  EXPECT_EQ(tables["handles"]["chin"], test::built_head().handles.at("chin"));
  EXPECT_EQ(tables["handles"].size(), 42U);
  EXPECT_EQ(tables["rings"].size(), 15U + 9U + 9U);
  EXPECT_EQ(tables["rings"]["mouth5"].get<std::vector<std::uint32_t>>(),
            test::built_head().rings.at("mouth5"));
}

}  // namespace
}  // namespace mien
