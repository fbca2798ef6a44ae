#include "mien/transfer/deformation_transfer.h"

#include <Eigen/Sparse>
#include <utility>

#include "matrices.h"
#include "mien/base/contract.h"

namespace mien {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// Of a tie, beside the triangles around both vertices: how little they may part.
constexpr double kTieStiffness = 1e4;

double distance_squared(const Matrix3& a, const Matrix3& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += dot(a[i] - b[i], a[i] - b[i]);
  return sum;
}

// sum over corners of v g^T
Matrix3 gradient_of(std::span<const Point3> points, const Triangle& t, const std::array<Point3, 3>& g) {
  Matrix3 sum{};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < 3; ++i) sum[i] = sum[i] + points[t[c]][i] * g[c];
  return sum;
}

}  // namespace

std::vector<Matrix3> deformation_gradients(const Surface& rest, std::span<const Point3> deformed) {
  contract(rest.points.size() == deformed.size(), "deformation_gradients: sizes differ");
  std::vector<Matrix3> gradients;
  gradients.reserve(rest.triangles.size());
  const auto frame = [](std::span<const Point3> p, const Triangle& t) {
    const Point3 e1 = p[t[1]] - p[t[0]], e2 = p[t[2]] - p[t[0]];
    return std::array<Point3, 3>{e1, e2, unit(cross(e1, e2))};
  };
  for (const Triangle& t : rest.triangles) {
    const auto a = frame(rest.points, t), b = frame(deformed, t);
    Matrix3 inverse;
    gradients.push_back(invert_columns(a[0], a[1], a[2], inverse) ? from_columns(b[0], b[1], b[2]) * inverse
                                                                  : kIdentity);
  }
  return gradients;
}

struct DeformationTransfer::State {
  Surface target;
  std::vector<TrianglePair> pairs;  // sorted by target
  // Of each target triangle: its gradients, and whether it has any.
  std::vector<std::array<Point3, 3>> gradients;
  std::vector<bool> has_area, is_paired;
  std::vector<int> unknown;  // [V] row of the system, or -1 for held vertices
  std::vector<Anchor> anchors;
  std::vector<Tie> ties;
  std::vector<double> tie_weights;
  int num_unknown = 0;
  Sparse coupling;  // [unknown, V] to the held vertices
  Eigen::SimplicialLDLT<Sparse> factor;

  // Calls use(target triangle, gradient wanted) for every equation.
  template <class Use>
  void for_each_equation(std::span<const Matrix3> wanted, Use&& use) const {
    for (const TrianglePair& pair : pairs)
      if (has_area[pair.target]) use(pair.target, wanted.empty() ? kIdentity : wanted[pair.source]);
    for (std::uint32_t t = 0; t < target.triangles.size(); ++t)
      if (has_area[t] && !is_paired[t]) use(t, kIdentity);
  }
};

Result<DeformationTransfer> DeformationTransfer::create(Surface target, std::vector<TrianglePair> pairs,
                                                        std::span<const std::uint32_t> held,
                                                        std::vector<Anchor> anchors, std::vector<Tie> ties) {
  auto state = std::make_unique<State>();
  State& s = *state;
  s.target = std::move(target);
  s.pairs = std::move(pairs);
  s.anchors = std::move(anchors);
  s.ties = std::move(ties);
  const std::size_t num_vertices = s.target.points.size(), num_triangles = s.target.triangles.size();
  s.gradients.resize(num_triangles);
  s.has_area.resize(num_triangles);
  s.is_paired.resize(num_triangles);
  std::vector<Triangle> solid;
  for (std::size_t t = 0; t < num_triangles; ++t) {
    s.has_area[t] = barycentric_gradients(s.target, s.target.triangles[t], s.gradients[t]);
    if (s.has_area[t]) solid.push_back(s.target.triangles[t]);
  }
  for (const TrianglePair& pair : s.pairs) {
    contract(pair.target < num_triangles, "DeformationTransfer: a pair names a triangle that is not there");
    s.is_paired[pair.target] = true;
  }

  std::vector<bool> is_held(num_vertices), is_used(num_vertices);
  for (const Triangle& t : solid)
    for (const std::uint32_t v : t) is_used[v] = true;
  for (const std::uint32_t v : held) is_held.at(v) = true;
  for (std::size_t v = 0; v < num_vertices; ++v)
    if (!is_used[v]) is_held[v] = true;
  for (const Tie& tie : s.ties) {
    contract(tie.a < num_vertices && tie.b < num_vertices,
             "DeformationTransfer: a tie names a vertex that is not there");
    solid.push_back({tie.a, tie.b, tie.b});
  }
  const auto component = components(num_vertices, solid);
  std::vector<bool> is_placed(num_vertices);  // components
  for (std::size_t v = 0; v < num_vertices; ++v)
    if (is_held[v]) is_placed[component[v]] = true;
  for (const Anchor& anchor : s.anchors)
    if (anchor.weight > 0) is_placed[component.at(anchor.vertex)] = true;
  for (std::size_t v = 0; v < num_vertices; ++v) {
    if (is_placed[component[v]]) continue;
    is_held[v] = is_placed[component[v]] = true;
  }
  for (std::size_t v = 0; v < num_vertices; ++v) s.unknown.push_back(is_held[v] ? -1 : s.num_unknown++);

  std::vector<Eigen::Triplet<double>> inner, outer;
  std::vector<double> stiffness(num_vertices);
  const auto add = [&](std::uint32_t v, std::uint32_t other, double value) {
    if (s.unknown[v] < 0) return;
    if (s.unknown[other] < 0)
      outer.emplace_back(s.unknown[v], static_cast<int>(other), value);
    else
      inner.emplace_back(s.unknown[v], s.unknown[other], value);
  };
  s.for_each_equation({}, [&](std::uint32_t t, const Matrix3&) {
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        const std::uint32_t va = s.target.triangles[t][a], vb = s.target.triangles[t][b];
        const double value = dot(s.gradients[t][a], s.gradients[t][b]);
        add(va, vb, value);
        if (a == b) stiffness[va] += value;
      }
  });
  for (const Tie& tie : s.ties) {
    const double weight = kTieStiffness * (stiffness[tie.a] + stiffness[tie.b]);
    s.tie_weights.push_back(weight);
    add(tie.a, tie.a, weight);
    add(tie.b, tie.b, weight);
    add(tie.a, tie.b, -weight);
    add(tie.b, tie.a, -weight);
  }
  for (const Anchor& anchor : s.anchors)
    if (const int row = s.unknown[anchor.vertex]; row >= 0) inner.emplace_back(row, row, anchor.weight);
  Sparse matrix(s.num_unknown, s.num_unknown);
  matrix.setFromTriplets(inner.begin(), inner.end());
  s.coupling.resize(s.num_unknown, static_cast<int>(num_vertices));
  s.coupling.setFromTriplets(outer.begin(), outer.end());
  if (s.num_unknown > 0) s.factor.compute(matrix);
  if (s.num_unknown > 0 && s.factor.info() != Eigen::Success)
    return Error{Errc::input, "target mesh", "its triangles do not hold together: the system is singular",
                 "Look for vertices that are not finite or triangles that are folded to lines"};
  return DeformationTransfer(std::move(state));
}

DeformationTransfer::Shape DeformationTransfer::transfer(std::span<const Matrix3> gradients,
                                                         std::span<const Point3> places) const {
  const State& s = *state_;
  contract(places.size() == s.anchors.size(), "DeformationTransfer: every anchor needs a place");
  for (const TrianglePair& pair : s.pairs)
    contract(pair.source < gradients.size(),
             "DeformationTransfer: a pair names a gradient that is not there");
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(s.num_unknown, 3);
  s.for_each_equation(gradients, [&](std::uint32_t t, const Matrix3& wanted) {
    for (std::size_t c = 0; c < 3; ++c) {
      const int row = s.unknown[s.target.triangles[t][c]];
      if (row < 0) continue;
      const Point3 pull = wanted * s.gradients[t][c];  // S W W^+ g = S g: g lies in the plane
      for (int axis = 0; axis < 3; ++axis) rhs(row, axis) += pull[static_cast<std::size_t>(axis)];
    }
  });
  for (std::size_t i = 0; i < places.size(); ++i)
    if (const int row = s.unknown[s.anchors[i].vertex]; row >= 0)
      for (int axis = 0; axis < 3; ++axis)
        rhs(row, axis) += s.anchors[i].weight * places[i][static_cast<std::size_t>(axis)];
  for (std::size_t i = 0; i < s.ties.size(); ++i) {
    const auto [a, b] = s.ties[i];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double apart = s.tie_weights[i] * (s.target.points[a][axis] - s.target.points[b][axis]);
      if (s.unknown[a] >= 0) rhs(s.unknown[a], static_cast<Eigen::Index>(axis)) += apart;
      if (s.unknown[b] >= 0) rhs(s.unknown[b], static_cast<Eigen::Index>(axis)) -= apart;
    }
  }
  Eigen::MatrixXd rest(static_cast<Eigen::Index>(s.target.points.size()), 3);
  for (std::size_t v = 0; v < s.target.points.size(); ++v)
    for (std::size_t axis = 0; axis < 3; ++axis)
      rest(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(axis)) = s.target.points[v][axis];
  rhs -= s.coupling * rest;
  Eigen::MatrixXd found(s.num_unknown, 3);
  if (s.num_unknown > 0) found = s.factor.solve(rhs);
  Shape shape;
  shape.points = s.target.points;
  for (std::size_t v = 0; v < shape.points.size(); ++v)
    if (s.unknown[v] >= 0)
      shape.points[v] = {found(s.unknown[v], 0), found(s.unknown[v], 1), found(s.unknown[v], 2)};
  s.for_each_equation(gradients, [&](std::uint32_t t, const Matrix3& wanted) {
    // Both sides within the plane of the triangle at rest.
    const Triangle& corners = s.target.triangles[t];
    const auto& g = s.gradients[t];
    Matrix3 aim{};
    for (std::size_t c = 0; c < 3; ++c) {
      const Point3 place = wanted * s.target.points[corners[c]];
      for (std::size_t i = 0; i < 3; ++i) aim[i] = aim[i] + place[i] * g[c];
    }
    shape.energy += distance_squared(gradient_of(shape.points, corners, g), aim);
  });
  return shape;
}

DeformationTransfer::DeformationTransfer(std::unique_ptr<State> state) : state_(std::move(state)) {}
DeformationTransfer::DeformationTransfer(DeformationTransfer&&) noexcept = default;
DeformationTransfer& DeformationTransfer::operator=(DeformationTransfer&&) noexcept = default;
DeformationTransfer::~DeformationTransfer() = default;

}  // namespace mien
