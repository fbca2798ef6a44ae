#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "mien/base/bytes.h"
#include "mien/core/character.h"
#include "mien/core/motion.h"
#include "test_paths.h"

namespace mien::test {

using Json = nlohmann::json;

/// A file beside the project, or nothing where it is absent.
inline std::optional<std::filesystem::path> shared_file(const std::string& name) {
  const auto path = shared_path(name);
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

inline constexpr const char* kFaces[] = {"ict_facekit", "makehuman_head", "arkit_reference",
                                         "mediapipe_canonical"};

/// Skin (a bent quad), eyes (a triangle), hair (no shapes).
inline Character tiny_character() {
  Character c;
  c.name = "tiny";
  CharacterPart skin;
  skin.name = "skin";
  skin.mesh.positions = {{0, 0, 0}, {0.1f, 0, 0}, {0.1f, 0.1f, 0.02f}, {0, 0.1f, 0}};
  skin.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  skin.mesh.normals = vertex_normals(skin.mesh.positions, skin.mesh.triangles);
  skin.mesh.colors.assign(4, {0.6f, 0.4f, 0.2f, 1.0f});
  skin.shapes = {{"jawOpen", {0, 1}, {{0, -0.02f, 0.001f}, {0, -0.01f, 0}}, {}},
                 {"mouthClose", {0}, {{0, 0.02f, 0}}, {}},
                 {"bulge", {2, 3}, {{0, 0, 0.01f}, {0.003f, 0, 0}}, {}}};
  CharacterPart hair;
  hair.name = "hair";
  hair.mesh.positions = {{0, 0.2f, 0}, {0.1f, 0.2f, 0}, {0, 0.3f, 0}};
  hair.mesh.triangles = {{0, 1, 2}};
  CharacterPart eyes;
  eyes.name = "eyes";
  eyes.mesh.positions = {{0, 0.05f, 0.1f}, {0.01f, 0.05f, 0.1f}, {0, 0.06f, 0.1f}};
  eyes.mesh.triangles = {{0, 1, 2}};
  eyes.shapes = {{"eyeLookUpLeft", {0, 2}, {{0, 0, 0.01f}, {0, 0.01f, 0}}, {}}};
  c.parts = {skin, hair, eyes};
  c.regions = {{"lips", {0, 1}}, {"landmarks68", {3, 2, 1, 0}}};
  return c;
}

/// A character of one quad and one shape: a short file to damage.
inline Character smallest_character() {
  Character c = tiny_character();
  c.parts.resize(1);
  c.parts[0].shapes.resize(1);
  return c;
}

inline void expect_same_shape(const Blendshape& a, const Blendshape& b, const std::string& where) {
  EXPECT_EQ(a.name, b.name) << where;
  EXPECT_EQ(a.vertices, b.vertices) << where << " " << a.name;
  EXPECT_EQ(a.offsets, b.offsets) << where << " " << a.name;
}

/// Geometry, shapes and regions bit for bit; normals within 1e-6, colours within a step of 1/65535. Shapes of
/// `read` may hold extra rows that move only normals.
inline void expect_same(const Character& read, const Character& made) {
  EXPECT_EQ(read.name, made.name);
  EXPECT_EQ(read.regions, made.regions);
  ASSERT_EQ(read.parts.size(), made.parts.size());
  for (std::size_t i = 0; i < made.parts.size(); ++i) {
    const auto& a = read.parts[i];
    const auto& b = made.parts[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.mesh.positions, b.mesh.positions) << b.name;
    EXPECT_EQ(a.mesh.triangles, b.mesh.triangles) << b.name;
    ASSERT_EQ(a.mesh.colors.size(), b.mesh.colors.size()) << b.name;
    for (std::size_t v = 0; v < b.mesh.colors.size(); ++v)
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(a.mesh.colors[v][k], b.mesh.colors[v][k], 1.0 / 65535);
    ASSERT_EQ(a.shapes.size(), b.shapes.size()) << b.name;
    for (std::size_t k = 0; k < b.shapes.size(); ++k) {
      Blendshape moved{a.shapes[k].name, {}, {}, {}};
      for (std::size_t r = 0; r < a.shapes[k].vertices.size(); ++r) {
        if (a.shapes[k].offsets[r] == Vec3{}) continue;
        moved.vertices.push_back(a.shapes[k].vertices[r]);
        moved.offsets.push_back(a.shapes[k].offsets[r]);
      }
      expect_same_shape(moved, b.shapes[k], b.name);
    }
  }
}

/// The two chunks of a .glb that is known to be whole.
struct Glb {
  Json json;
  Bytes bin;
};
inline Glb open_glb(const Bytes& bytes) {
  Glb glb;
  const auto json_size = *read_le<std::uint32_t>(bytes, 12);
  glb.json = Json::parse(as_text(std::span(bytes).subspan(20, json_size)));
  if (bytes.size() > 28 + json_size)
    glb.bin.assign(bytes.begin() + static_cast<std::ptrdiff_t>(28 + json_size), bytes.end());
  return glb;
}

/// A .glb from its chunks, written by hand so that the writer is not its own judge.
inline Bytes make_glb(const Json& json, Bytes bin) {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  bin.resize((bin.size() + 3) / 4 * 4);
  Bytes out;
  append_le(out, 0x46546C67u);
  append_le(out, 2u);
  append_le(out, static_cast<std::uint32_t>(28 + text.size() + bin.size()));
  append_le(out, static_cast<std::uint32_t>(text.size()));
  append_le(out, 0x4E4F534Au);
  for (const char c : text) out.push_back(static_cast<std::byte>(c));
  append_le(out, static_cast<std::uint32_t>(bin.size()));
  append_le(out, 0x004E4942u);
  out.insert(out.end(), bin.begin(), bin.end());
  return out;
}

/// Calls `read` with every prefix and with every byte flipped (one bit, the sign bit or all bits in turn).
/// Each call gets a buffer of exact size, so that a sanitizer sees reads beyond it. `may_succeed(n)` says
/// whether the prefix of n bytes is allowed to be fine.
template <class Read, class MaySucceed>
void torture(const Bytes& whole, Read read, MaySucceed may_succeed) {
  ASSERT_TRUE(read(Bytes(whole)));
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const bool fine = read(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n)));
    EXPECT_TRUE(!fine || may_succeed(n)) << "prefix of " << n << " of " << whole.size() << " bytes";
  }
  constexpr unsigned kFlips[] = {0x01u, 0x80u, 0xffu};
  for (std::size_t i = 0; i < whole.size(); ++i) {
    Bytes damaged = whole;
    damaged[i] ^= static_cast<std::byte>(kFlips[i % 3]);
    (void)read(damaged);  // any answer, as long as it is an answer
  }
}

}  // namespace mien::test
