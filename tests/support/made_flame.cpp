#include "made_flame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "mien/core/flame_parameters.h"
#include "pickle_text.h"

namespace mien {
namespace {

constexpr double kOpening = 0.3;  // radians that stand for jawOpen

bool is_expression(std::string_view name) {
  return !name.starts_with("jaw") && !name.starts_with("eyeLook") && name != "tongueOut";
}

std::vector<Vec3> spread_out(const Blendshape& shape, std::size_t num_vertices) {
  std::vector<Vec3> offsets(num_vertices);
  for (std::size_t m = 0; m < shape.vertices.size(); ++m) offsets[shape.vertices[m]] = shape.offsets[m];
  return offsets;
}

// Factors of the vertices, of sum 1, whose sum of positions is the point: the shortest such vector.
std::vector<double> factors_of(const std::vector<Vec3>& positions, const std::array<double, 3>& point) {
  const auto row = [](const Vec3& p) { return std::array<double, 4>{p.x, p.y, p.z, 1}; };
  std::array<std::array<double, 5>, 4> system{};
  for (const Vec3& p : positions)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) system[i][j] += row(p)[i] * row(p)[j];
  for (std::size_t i = 0; i < 4; ++i) system[i][4] = i < 3 ? point[i] : 1;
  for (std::size_t i = 0; i < 4; ++i)  // Gauss; the matrix is positive definite
    for (std::size_t k = 0; k < 4; ++k) {
      if (k == i) continue;
      const double factor = system[k][i] / system[i][i];
      for (std::size_t j = 0; j < 5; ++j) system[k][j] -= factor * system[i][j];
    }
  std::vector<double> factors;
  for (const Vec3& p : positions) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += row(p)[i] * system[i][4] / system[i][i];
    factors.push_back(sum);
  }
  return factors;
}

void put(std::vector<float>& values, std::size_t direction, std::size_t vertex, std::size_t num_vertices,
         double factor, const Vec3& offset) {
  float* at = values.data() + 3 * (direction * num_vertices + vertex);
  at[0] += static_cast<float>(factor * static_cast<double>(offset.x));
  at[1] += static_cast<float>(factor * static_cast<double>(offset.y));
  at[2] += static_cast<float>(factor * static_cast<double>(offset.z));
}

}  // namespace

FlameModel made_flame(const Mesh& mesh, std::span<const Blendshape> shapes, std::size_t num_expressions) {
  const std::size_t count = mesh.positions.size();
  std::vector<std::vector<Vec3>> expressions;
  std::vector<Vec3> opening;
  for (const Blendshape& shape : shapes) {
    if (shape.name == "jawOpen") opening = spread_out(shape, count);
    if (is_expression(shape.name) && !shape.vertices.empty()) expressions.push_back(spread_out(shape, count));
  }
  if (opening.empty() || expressions.empty()) throw std::invalid_argument("made_flame: shapes are missing");

  FlameModel m;
  m.num_vertices = static_cast<std::int64_t>(count);
  m.num_shapes = static_cast<std::int64_t>(kNumFlameShape + std::max(num_expressions, expressions.size()));
  m.parents = {-1, 0, 1, 1, 1};
  m.triangles = mesh.triangles;
  m.shapes.resize(3 * count * static_cast<std::size_t>(m.num_shapes));
  m.pose_shapes.resize(3 * count * kNumFlamePoseFeatures);
  m.joint_regressor.resize(kNumFlameJoints * count);
  m.weights.resize(kNumFlameJoints * count);
  std::size_t lowest = 0;  // the vertex that jawOpen moves most
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3& p = mesh.positions[v];
    m.neutral.insert(m.neutral.end(), {p.x, p.y, p.z});
    put(m.shapes, 0, v, count, 0.02, p);
    for (std::size_t e = 0; e < expressions.size(); ++e) {
      put(m.shapes, kNumFlameShape + e, v, count, 0.3, expressions[e][v]);
      if (e + 1 < expressions.size())
        put(m.shapes, kNumFlameShape + e, v, count, 0.15, expressions[e + 1][v]);
    }
    if (dot(opening[v], opening[v]) > dot(opening[lowest], opening[lowest])) lowest = v;
  }
  // A small rotation r about x moves a point at (y, z) from the joint by (-r z, r y).
  const Vec3 at = mesh.positions[lowest], moved = opening[lowest];
  const double joint_y = static_cast<double>(at.y) - static_cast<double>(moved.z) / kOpening,
               joint_z = static_cast<double>(at.z) + static_cast<double>(moved.y) / kOpening;
  const auto jaw = static_cast<std::size_t>(FlameJoint::jaw);
  const auto at_jaw = factors_of(mesh.positions, {0, joint_y, joint_z});
  const auto at_origin = factors_of(mesh.positions, {0, 0, 0});
  const std::size_t feature = 9 * (jaw - 1) + 3 * 1 + 2;  // minus the sine of the jaw's turn about x
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3& p = mesh.positions[v];
    const double arm = std::hypot(static_cast<double>(p.y) - joint_y, static_cast<double>(p.z) - joint_z);
    const double way = std::sqrt(static_cast<double>(dot(opening[v], opening[v])));
    const double share = arm > 0 ? std::clamp(way / (kOpening * arm), 0.0, 1.0) : 0;
    m.weights[v * kNumFlameJoints + jaw] = static_cast<float>(share);
    m.weights[v * kNumFlameJoints + static_cast<std::size_t>(FlameJoint::neck)] =
        static_cast<float>(1 - share);
    for (std::size_t j = 0; j < kNumFlameJoints; ++j)
      m.joint_regressor[j * count + v] = static_cast<float>(j == jaw ? at_jaw[v] : at_origin[v]);
    put(m.pose_shapes, feature, v, count, 0.2, expressions.front()[v]);
  }
  return m;
}

std::string flame_pickle(const FlameModel& m) {
  using pickle_text::array, pickle_text::text;
  const auto count = static_cast<std::size_t>(m.num_vertices);
  // Directions lie side by side in the file.
  const auto by_vertex = [&](const std::vector<float>& directions) {
    const std::size_t depth = directions.size() / (3 * count);
    std::vector<float> values(directions.size());
    for (std::size_t d = 0; d < depth; ++d)
      for (std::size_t i = 0; i < 3 * count; ++i) values[i * depth + d] = directions[d * 3 * count + i];
    return array(values, "f4", {count, 3, depth});
  };
  std::vector<float> table;
  for (const int parent : m.parents) table.push_back(static_cast<float>(parent));
  for (std::size_t j = 0; j < kNumFlameJoints; ++j) table.push_back(static_cast<float>(j));
  std::vector<std::int32_t> faces;
  for (const auto& triangle : m.triangles)
    for (const auto v : triangle) faces.push_back(static_cast<std::int32_t>(v));
  return pickle_text::dict({{text("v_template"), array(m.neutral, "f4", {count, 3})},
                            {text("shapedirs"), by_vertex(m.shapes)},
                            {text("posedirs"), by_vertex(m.pose_shapes)},
                            {text("J_regressor"), array(m.joint_regressor, "f4", {kNumFlameJoints, count})},
                            {text("weights"), array(m.weights, "f4", {count, kNumFlameJoints})},
                            {text("kintree_table"), array(table, "f4", {2, kNumFlameJoints})},
                            {text("f"), array(faces, "i4", {faces.size() / 3, 3})}}) +
         ".";
}

}  // namespace mien
