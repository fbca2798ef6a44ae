#include "gltf_primitive.h"

#include <algorithm>
#include <cmath>

#include "gltf_accessor.h"

namespace mien::io {
namespace {

constexpr std::size_t kTriangles = 4, kStrip = 5, kFan = 6;

Error bad_primitive(std::string why) { return {Errc::input, "glTF primitive", std::move(why), ""}; }

Vec3 at(const std::vector<float>& values, std::size_t v) {
  return {values[3 * v], values[3 * v + 1], values[3 * v + 2]};
}

void add_scaled(std::vector<float>& sum, float weight, const std::vector<float>& values) {
  if (sum.empty()) sum.resize(values.size());
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * values[i];
}

Result<std::vector<std::array<std::uint32_t, 3>>> read_triangles(const GltfDocument& document,
                                                                 const Json& primitive, std::size_t mode,
                                                                 std::size_t num_vertices,
                                                                 ReadBudget& budget) {
  std::vector<std::uint32_t> corners;
  if (const auto accessor = index_member(primitive, "indices")) {
    MIEN_TRY(const auto info, accessor_info(document, *accessor));
    MIEN_TRY([[maybe_unused]] const auto paid, budget.spend(info.count));
    MIEN_TRY(corners, read_integers(document, *accessor, 1));
  } else {
    for (std::size_t v = 0; v < num_vertices; ++v) corners.push_back(static_cast<std::uint32_t>(v));
  }
  for (const auto c : corners)
    if (c >= num_vertices)
      return bad_primitive("triangle corner " + std::to_string(c) + " of " + std::to_string(num_vertices) +
                           " vertices");
  std::vector<std::array<std::uint32_t, 3>> triangles;
  if (mode == kTriangles) {
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
      triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  } else {
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
      if (mode == kFan)
        triangles.push_back({corners[i + 1], corners[i + 2], corners[0]});
      else  // every second triangle of a strip runs the other way round
        triangles.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    }
  }
  return triangles;
}

Result<std::vector<std::array<float, 4>>> read_colors(const GltfDocument& document, std::size_t accessor,
                                                      std::size_t num_vertices) {
  MIEN_TRY(const auto info, accessor_info(document, accessor));
  if (info.components != 3 && info.components != 4)
    return bad_primitive("its colours are neither RGB nor RGBA");
  MIEN_TRY(const auto values, read_floats(document, accessor, info.components, num_vertices));
  const auto width = static_cast<std::size_t>(info.components);
  std::vector<std::array<float, 4>> colors(num_vertices);
  for (std::size_t v = 0; v < num_vertices; ++v)
    colors[v] = {values[v * width], values[v * width + 1], values[v * width + 2],
                 width == 4 ? values[v * width + 3] : 1.0f};
  return colors;
}

// One matrix for all vertices, or one per vertex of a skinned mesh.
Result<std::vector<Matrix>> vertex_matrices(const GltfDocument& document, const Json& attributes,
                                            const MeshPlacement& placement, std::size_t num_vertices) {
  const auto joints = index_member(attributes, "JOINTS_0");
  const auto weights = index_member(attributes, "WEIGHTS_0");
  if (placement.joints.empty() || !joints || !weights) return std::vector<Matrix>{placement.world};
  MIEN_TRY(const auto joint, read_integers(document, *joints, 4, num_vertices));
  MIEN_TRY(const auto weight, read_floats(document, *weights, 4, num_vertices));
  std::vector<Matrix> matrices(num_vertices);
  for (std::size_t v = 0; v < num_vertices; ++v) {
    double sum = 0;
    for (std::size_t k = 4 * v; k < 4 * v + 4; ++k) {
      if (weight[k] == 0) continue;
      if (joint[k] >= placement.joints.size())
        return bad_primitive("a vertex follows a joint that its skin does not have");
      for (std::size_t i = 0; i < 16; ++i) matrices[v][i] += weight[k] * placement.joints[joint[k]][i];
      sum += weight[k];
    }
    if (!(sum > 0)) matrices[v] = placement.world, sum = 1;
    for (double& entry : matrices[v]) entry /= sum;
  }
  return matrices;
}

// The attributes of a primitive as they stand in the file.
struct RawPrimitive {
  std::vector<float> positions, normals;  // [V, 3]; normals may be empty
  std::size_t num_vertices = 0;
};

// Carries vertices, normals and their offsets into the common space.
class Mover {
 public:
  Mover(const std::vector<Matrix>& matrices, const RawPrimitive& raw) : matrices_(matrices), raw_(raw) {
    for (const Matrix& m : matrices) {
      normal_matrices_.push_back(normal_matrix(m));
      signs_.push_back(determinant(m) < 0 ? -1.0f : 1.0f);
    }
  }

  [[nodiscard]] bool mirrors() const { return signs_[0] < 0; }
  [[nodiscard]] Vec3 position(std::size_t v) const {
    return transform_point(matrix(v), at(raw_.positions, v));
  }
  [[nodiscard]] Vec3 offset(std::size_t v, Vec3 d) const { return transform_vector(matrix(v), d); }
  [[nodiscard]] Vec3 normal(std::size_t v) const {
    const Vec3 n = turned(v, at(raw_.normals, v));
    const float size = length(n);
    return size > 0 && std::isfinite(size) ? (1.0f / size) * n : Vec3{0, 0, 1};
  }
  [[nodiscard]] Vec3 normal_offset(std::size_t v, Vec3 d) const {
    const float size = length(turned(v, at(raw_.normals, v)));
    return size > 0 && std::isfinite(size) ? (1.0f / size) * turned(v, d) : Vec3{};
  }

 private:
  [[nodiscard]] std::size_t slot(std::size_t v) const { return matrices_.size() == 1 ? 0 : v; }
  [[nodiscard]] const Matrix& matrix(std::size_t v) const { return matrices_[slot(v)]; }
  [[nodiscard]] Vec3 turned(std::size_t v, Vec3 n) const {
    return signs_[slot(v)] * transform_vector(normal_matrices_[slot(v)], n);
  }

  const std::vector<Matrix>& matrices_;
  const RawPrimitive& raw_;
  std::vector<Matrix> normal_matrices_;
  std::vector<float> signs_;
};

Result<std::vector<float>> read_target(const GltfDocument& document, const Json& targets, std::size_t target,
                                       const char* attribute, std::size_t num_vertices, ReadBudget& budget) {
  const auto accessor = index_member(targets[target], attribute);
  if (!accessor) return std::vector<float>{};
  MIEN_TRY([[maybe_unused]] const auto paid, budget.spend(num_vertices));
  return read_floats(document, *accessor, 3, num_vertices);
}

Blendshape sparse_shape(const std::string& name, const std::vector<float>& offsets,
                        const std::vector<float>& normals, std::size_t num_vertices, const Mover& mover) {
  Blendshape shape{name, {}, {}, {}};
  for (std::size_t v = 0; v < num_vertices; ++v) {
    const Vec3 d = offsets.empty() ? Vec3{} : at(offsets, v);
    const Vec3 n = normals.empty() ? Vec3{} : at(normals, v);
    if (d == Vec3{} && n == Vec3{}) continue;
    shape.vertices.push_back(static_cast<std::uint32_t>(v));
    shape.offsets.push_back(mover.offset(v, d));
    if (!normals.empty()) shape.normal_offsets.push_back(mover.normal_offset(v, n));
  }
  return shape;
}

bool is_finite(const std::vector<Vec3>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); });
}

}  // namespace

Result<std::optional<CharacterPart>> read_primitive(const GltfDocument& document, const Json& primitive,
                                                    const ShapePlan& plan, const MeshPlacement& placement,
                                                    ReadBudget& budget) {
  if (member(member(primitive, "extensions"), "KHR_draco_mesh_compression").is_object())
    return Error{Errc::incompatible, "glTF primitive", "is compressed by KHR_draco_mesh_compression",
                 "Export the character without compression"};
  const std::size_t mode = index_member(primitive, "mode").value_or(kTriangles);
  if (mode != kTriangles && mode != kStrip && mode != kFan) return std::optional<CharacterPart>{};

  const Json& attributes = member(primitive, "attributes");
  const auto position_accessor = index_member(attributes, "POSITION");
  if (!position_accessor) return bad_primitive("has no POSITION");
  MIEN_TRY(const auto info, accessor_info(document, *position_accessor));
  MIEN_TRY([[maybe_unused]] const auto paid, budget.spend(info.count));
  RawPrimitive raw;
  raw.num_vertices = info.count;
  MIEN_TRY(raw.positions, read_floats(document, *position_accessor, 3));
  if (const auto accessor = index_member(attributes, "NORMAL")) {
    MIEN_TRY(raw.normals, read_floats(document, *accessor, 3, raw.num_vertices));
  }

  CharacterPart part;
  MIEN_TRY(part.mesh.triangles, read_triangles(document, primitive, mode, raw.num_vertices, budget));
  if (const auto accessor = index_member(attributes, "COLOR_0")) {
    MIEN_TRY(part.mesh.colors, read_colors(document, *accessor, raw.num_vertices));
  }

  const Json& targets = array_member(primitive, "targets");
  if (targets.size() != plan.baked.size())
    return bad_primitive("its number of targets differs from the rest of its mesh");
  for (std::size_t t = 0; t < targets.size(); ++t) {
    if (plan.baked[t] == 0) continue;
    MIEN_TRY(const auto d, read_target(document, targets, t, "POSITION", raw.num_vertices, budget));
    if (!d.empty()) add_scaled(raw.positions, plan.baked[t], d);
  }

  MIEN_TRY(const auto matrices, vertex_matrices(document, attributes, placement, raw.num_vertices));
  const Mover mover(matrices, raw);
  for (std::size_t v = 0; v < raw.num_vertices; ++v) part.mesh.positions.push_back(mover.position(v));
  if (!raw.normals.empty())
    for (std::size_t v = 0; v < raw.num_vertices; ++v) part.mesh.normals.push_back(mover.normal(v));
  if (mover.mirrors())
    for (auto& triangle : part.mesh.triangles) std::swap(triangle[1], triangle[2]);

  for (const auto& planned : plan.shapes) {
    std::vector<float> offsets, normals;
    for (const std::size_t t : planned.targets) {
      MIEN_TRY(const auto d, read_target(document, targets, t, "POSITION", raw.num_vertices, budget));
      if (!d.empty()) add_scaled(offsets, 1.0f, d);
      if (raw.normals.empty()) continue;
      MIEN_TRY(const auto n, read_target(document, targets, t, "NORMAL", raw.num_vertices, budget));
      if (!n.empty()) add_scaled(normals, 1.0f, n);
    }
    Blendshape shape = sparse_shape(planned.name, offsets, normals, raw.num_vertices, mover);
    if (!is_finite(shape.offsets))
      return bad_primitive("shape '" + planned.name + "' moves a vertex out of range");
    if (!shape.vertices.empty()) part.shapes.push_back(std::move(shape));
  }
  if (!is_finite(part.mesh.positions)) return bad_primitive("a vertex lies out of range");
  return std::optional<CharacterPart>(std::move(part));
}

}  // namespace mien::io
