#include "mien/io/mesh_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "mien/base/file.h"
#include "mien/io/vl.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
using Triangle = std::array<std::uint32_t, 3>;

constexpr std::string_view kSquare =
    "# a square\no face\nv 0 0 0\nv 1 0 0\r\nv 1 1 0 0.5 0.5 0.5\nv 0 1 -2.5e-1\nvt 0 0\nf 1/1 2/1/1 3//4 -1 "
    "# all\n";

TEST(Obj, KeepsTheOrderOfVerticesAndFansPolygons) {
  const auto mesh = read_obj(kSquare);
  ASSERT_TRUE(mesh) << mesh.error().message();
  ASSERT_EQ(mesh->positions.size(), 4u);
  EXPECT_EQ(mesh->positions[3], (Vec3{0, 1, -0.25f}));
  EXPECT_EQ(mesh->triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_TRUE(mesh.warnings.empty());
  const auto again = read_obj(write_obj(*mesh));
  EXPECT_EQ(again->positions, mesh->positions);
  EXPECT_EQ(again->triangles, mesh->triangles);
}

TEST(Obj, UnusedAndRepeatedVerticesStay) {
  const auto mesh = read_obj("v 1 2 3\nv 1 2 3\nv 9 9 9\nv 0 0 1\nf 1 2 4\n");
  EXPECT_EQ(mesh->positions.size(), 4u);
  EXPECT_TRUE(read_obj("")->positions.empty());
}

TEST(Obj, DamageIsNamedWithItsLine) {
  for (const char* text :
       {"v 1 2\n", "v 1 2 x\n", "v nan 0 0\n", "v 1e99 0 0\n", "v 0 0 0\nf 1 1\n", "f 1 2 3\n",
        "v 0 0 0\nf 0 1 1\n", "v 0 0 0\nf -2 1 1\n", "v 0 0 0\nf 1 1 99999999999999999999\n"}) {
    const auto mesh = read_obj(text);
    ASSERT_FALSE(mesh) << text;
    EXPECT_EQ(mesh.error().code, Errc::input) << text;
  }
  EXPECT_NE(read_obj("v 0 0 0\nv 1 2 x\n").error().message().find("line 2"), std::string::npos);
  EXPECT_EQ(read_obj("curv 1\n").warnings.size(), 1u);
}

std::string binary_ply() {
  std::string text =
      "ply\nformat binary_little_endian 1.0\ncomment none\nelement vertex 3\nproperty float x\nproperty "
      "uchar red\n"
      "property float y\nproperty double z\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  Bytes body;
  for (int v = 0; v < 3; ++v) {
    append_le(body, static_cast<float>(v));
    append_le(body, std::uint8_t{200});
    append_le(body, static_cast<float>(10 * v));
    append_le(body, -1.5);
  }
  append_le(body, std::uint8_t{3});
  for (const int v : {2, 1, 0}) append_le(body, static_cast<std::int32_t>(v));
  return text + std::string(as_text(body));
}

TEST(Ply, ReadsTextAndBinaryWithOtherProperties) {
  const auto binary = read_ply(as_bytes(binary_ply()));
  ASSERT_TRUE(binary) << binary.error().message();
  EXPECT_EQ(binary->positions[2], (Vec3{2, 20, -1.5f}));
  EXPECT_EQ(binary->triangles, (std::vector<Triangle>{{2, 1, 0}}));
  const auto text = read_ply(as_bytes(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 "
      "3\n"));
  ASSERT_TRUE(text) << text.error().message();
  EXPECT_EQ(text->triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Ply, EveryTruncationIsAnErrorAndHostileCountsAreNotAllocated) {
  const std::string whole = binary_ply();
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const std::vector<char> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
    EXPECT_FALSE(read_ply(std::as_bytes(std::span(cut)))) << n;
  }
  const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  const std::string tail = "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (const char* count : {"-1", "100000000000000000000", "199999999", "2"})
    EXPECT_FALSE(read_ply(as_bytes(head + count + tail))) << count;
  EXPECT_EQ(read_ply(as_bytes("ply\nformat binary_big_endian 1.0\nend_header\n")).error().code,
            Errc::incompatible);
}

TEST(Vl, RoundTripAndDamage) {
  const std::vector<Vec3> points = {{1, 2, 3}, {-0.5f, 0, 1e-6f}};
  const Bytes bytes = write_vl(points);
  EXPECT_EQ(bytes.size(), 28u);
  EXPECT_EQ(read_vl(bytes).value(), points);
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
    EXPECT_FALSE(read_vl(cut)) << n;
  }
  Bytes longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(read_vl(longer));
  Bytes broken = bytes;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(broken.data() + 4, &nan, 4);
  EXPECT_FALSE(read_vl(broken));
  EXPECT_TRUE(read_vl(write_vl({}))->empty());
}

TEST(MeshFile, IsChosenByExtensionAndNamedInErrors) {
  const fs::path folder = fs::temp_directory_path() / ("mien_mesh_" + std::to_string(getpid()));
  fs::create_directories(folder);
  ASSERT_TRUE(write_file(folder / "a.obj", kSquare));
  ASSERT_TRUE(write_file(folder / "a.ply", std::string_view(binary_ply())));
  ASSERT_TRUE(write_file(folder / "empty.obj", std::string_view("")));
  EXPECT_EQ(load_mesh(folder / "a.obj")->positions.size(), 4u);
  EXPECT_EQ(load_mesh(folder / "a.ply")->positions.size(), 3u);
  EXPECT_EQ(load_mesh(folder / "empty.obj").error().code, Errc::input);
  EXPECT_EQ(load_mesh(folder / "a.stl").error().code, Errc::usage);
  const auto missing = load_mesh(folder / "none.obj");
  EXPECT_EQ(missing.error().code, Errc::input);
  EXPECT_NE(missing.error().message().find("none.obj"), std::string::npos);
  fs::remove_all(folder);
}

TEST(MeshFile, PartsOfACharacterBecomeOneMesh) {
  Character character;
  const Mesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}, {}};
  character.parts = {{"skin", triangle, {}}, {"teeth", triangle, {}}};
  const Mesh mesh = merged_mesh(character);
  EXPECT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.triangles[1], (Triangle{3, 4, 5}));
}

}  // namespace
}  // namespace mien
