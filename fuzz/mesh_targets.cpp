// Meshes and frames of vertices.
#include <array>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/io/mesh_file.h"
#include "mien/io/vl.h"
#include "target.h"

namespace mien::fuzz {
namespace {

using namespace std::literals;

// What every reader of meshes promises.
Outcome check(const Result<Mesh>& mesh) {
  if (mesh) {
    for (const Vec3& p : mesh->positions)
      contract(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "fuzz: positions are finite");
    for (const auto& triangle : mesh->triangles)
      for (const auto vertex : triangle)
        contract(vertex < mesh->positions.size(), "fuzz: corners are vertices");
    if (mesh->positions.size() < 100'000) {
      const auto again = read_obj(write_obj(*mesh));
      contract(again.has_value() && again->positions.size() == mesh->positions.size() &&
                   again->triangles == mesh->triangles,
               "fuzz: what was read can be written");
    }
  }
  return outcome_of(mesh, mesh ? mesh->positions.size() + mesh->triangles.size() : 0);
}

std::vector<Bytes> obj_seeds() {
  return {
      bytes_of("# a square\no s\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nf 1 2 3 4\n"),
      bytes_of(
          "v -1e-3 2 3 1 0 0\nv 4 5 6\nv 7 8 9\nvt 0 0\nvn 0 0 1\ng a\nusemtl b\ns 1\nf 1/1/1 2//1 -1\n")};
}
Outcome read_obj_bytes(std::span<const std::byte> bytes) { return check(read_obj(as_text(bytes))); }
constexpr std::array<std::string_view, 12> kObjWords = {"v ",  "f ",    "\n",         "/",    "//", "-1",
                                                        "nan", "1e999", "4294967296", "\\\n", " ",  "\r\n"};

std::vector<Bytes> ply_seeds() {
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  binary += std::string(36, '\0') + "\x03\0\0\0\0\x01\0\0\0\x02\0\0\0"s;
  return {
      bytes_of(binary),
      bytes_of("ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty double y\n"
               "property float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_index\n"
               "element other 1\nproperty short s\nend_header\n0 0 0 1\n1 0 0 2\n1 1 0 3\n0 1 0 4\n4 0 1 2 "
               "3\n7\n")};
}
Outcome read_ply_bytes(std::span<const std::byte> bytes) { return check(read_ply(bytes)); }
constexpr std::array<std::string_view, 12> kPlyWords = {"element vertex 4294967295\n",
                                                        "element face 2\n",
                                                        "property list uchar int vertex_indices\n",
                                                        "property list double float z\n",
                                                        "property float x\n",
                                                        "format ascii 1.0\n",
                                                        "format binary_little_endian 1.0\n",
                                                        "end_header\n",
                                                        "\n",
                                                        "-1 ",
                                                        "nan ",
                                                        "comment "};

std::vector<Bytes> vl_seeds() {
  return {write_vl(std::vector<Vec3>{{0, 1, 2}, {-3, 4.5f, 6}}), write_vl(std::vector<Vec3>{})};
}
Outcome read_vl_bytes(std::span<const std::byte> bytes) {
  const auto frame = read_vl(bytes);
  if (frame) {
    const Bytes again = write_vl(*frame);
    contract(std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()),
             "fuzz: a frame is written as it was read");
  }
  return outcome_of(frame, frame ? frame->size() : 0);
}
constexpr std::array<std::string_view, 3> kVlWords = {"\xff\xff\xff\xff"sv, "\0\0\x80\x7f"sv, "\0\0\0\0"sv};

}  // namespace

Target obj_target() { return {"obj", &obj_seeds, &read_obj_bytes, kObjWords}; }
Target ply_target() { return {"ply", &ply_seeds, &read_ply_bytes, kPlyWords}; }
Target vl_target() { return {"vl", &vl_seeds, &read_vl_bytes, kVlWords}; }

}  // namespace mien::fuzz
