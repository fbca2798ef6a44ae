#include "mien/transfer/registration.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <map>
#include <string>

#include "matrices.h"
#include "nearest.h"

namespace mien {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

// The deformation of a triangle is linear in its three corners and a fourth point above the first corner,
// which stands for its normal: transposed, it is sum over the four of coefficient * position^T.
struct Tetrahedron {
  std::array<int, 4> vertices{};
  std::array<Point3, 4> coefficients{};
};

// Neighbours over an edge. Edges of more than two triangles join each with the first.
std::vector<std::pair<int, int>> neighbours(std::span<const Triangle> triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> first;
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto edge = std::minmax(triangles[t][c], triangles[t][(c + 1) % 3]);
      const auto [entry, is_new] = first.try_emplace({edge.first, edge.second}, static_cast<int>(t));
      if (!is_new) pairs.emplace_back(entry->second, static_cast<int>(t));
    }
  return pairs;
}

class Registration {
 public:
  Registration(const Surface& source, const Surface& target, std::span<const Marker> markers,
               const RegistrationOptions& options, double edge)
      : source_(source),
        target_(target),
        options_(options),
        edge_(edge),
        tree_(target.points),
        target_normals_(point_normals(target)) {
    for (const Marker& m : markers) marker_of_[m.source] = m.target;
    const std::size_t num_vertices = source.points.size();
    for (std::uint32_t v = 0; v < num_vertices; ++v)
      row_.push_back(marker_of_.contains(v) ? -1 : num_rows_++);
    add_tetrahedra();
    add_terms();
    for (std::uint32_t t = 0; t < target.triangles.size(); ++t)
      for (const std::uint32_t v : target.triangles[t]) around_.emplace(v, t);
  }

  // Minimises the energy with nearest points at the given weight (0: without). False: singular.
  bool solve(const std::vector<Point3>& places, double weight) {
    Triplets entries = matrix_;
    Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(num_rows_, 3);
    for (const auto& [row, vertex, value] : to_markers_) subtract(rhs, row, value, target_point(vertex));
    for (const auto& [row, axis, value] : identity_rhs_) rhs(row, axis) += value;
    if (weight > 0) add_closest(places, weight, entries, rhs);
    Sparse matrix(num_rows_, num_rows_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Sparse> factor(matrix);
    if (factor.info() != Eigen::Success) return false;
    const Eigen::MatrixXd found = factor.solve(rhs);
    result_.resize(source_.points.size());
    for (std::uint32_t v = 0; v < result_.size(); ++v) {
      const int r = row_[v];
      result_[v] =
          r < 0 ? target_.points[marker_of_.at(v)] : edge_ * Point3{found(r, 0), found(r, 1), found(r, 2)};
    }
    return true;
  }
  [[nodiscard]] const std::vector<Point3>& result() const { return result_; }

 private:
  void add_tetrahedra() {
    const auto num_vertices = static_cast<int>(source_.points.size());
    for (const Triangle& t : source_.triangles) {
      const Point3 e1 = (1 / edge_) * (source_.points[t[1]] - source_.points[t[0]]),
                   e2 = (1 / edge_) * (source_.points[t[2]] - source_.points[t[0]]);
      Tetrahedron tetrahedron;
      Matrix3 inverse;
      const int fourth = num_vertices + static_cast<int>(tetrahedra_.size());
      row_.push_back(num_rows_++);
      tetrahedron.vertices = {static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]), fourth};
      if (invert_columns(e1, e2, unit(cross(e1, e2)), inverse))
        tetrahedron.coefficients = {Point3{} - (inverse[0] + inverse[1] + inverse[2]), inverse[0], inverse[1],
                                    inverse[2]};
      tetrahedra_.push_back(tetrahedron);
      // A triangle without area bends nothing; its fourth point still needs an equation.
      if (tetrahedron.coefficients[3] == Point3{}) matrix_.emplace_back(row_.back(), row_.back(), 1.0);
    }
  }

  // weight * || sum of coefficients * positions - aim ||^2 for the three columns of a deformation
  void add_term(std::span<const std::pair<int, Point3>> parts, double weight, bool aims_at_identity) {
    for (const auto& [va, a] : parts) {
      const int r = row_[static_cast<std::size_t>(va)];
      if (r < 0) continue;
      for (const auto& [vb, b] : parts) {
        const double value = weight * dot(a, b);
        if (const int c = row_[static_cast<std::size_t>(vb)]; c >= 0)
          matrix_.emplace_back(r, c, value);
        else
          to_markers_.emplace_back(r, static_cast<std::uint32_t>(vb), value);
      }
      if (aims_at_identity)
        for (int axis = 0; axis < 3; ++axis)
          identity_rhs_.emplace_back(r, axis, weight * a[static_cast<std::size_t>(axis)]);
    }
  }

  void add_terms() {
    std::vector<std::pair<int, Point3>> parts;
    for (const auto& [ta, tb] : neighbours(source_.triangles)) {
      parts.clear();
      const Tetrahedron &a = tetrahedra_[static_cast<std::size_t>(ta)],
                        &b = tetrahedra_[static_cast<std::size_t>(tb)];
      for (std::size_t i = 0; i < 4; ++i) parts.emplace_back(a.vertices[i], a.coefficients[i]);
      for (std::size_t i = 0; i < 4; ++i) {
        const auto same = std::find_if(parts.begin(), parts.begin() + 4,
                                       [&](const auto& part) { return part.first == b.vertices[i]; });
        if (same != parts.begin() + 4)
          same->second = same->second - b.coefficients[i];
        else
          parts.emplace_back(b.vertices[i], Point3{} - b.coefficients[i]);
      }
      // Each of the two has the other as its neighbour.
      add_term(parts, 2 * options_.smoothness, false);
    }
    for (const Tetrahedron& t : tetrahedra_) {
      parts.clear();
      for (std::size_t i = 0; i < 4; ++i) parts.emplace_back(t.vertices[i], t.coefficients[i]);
      add_term(parts, options_.identity, true);
    }
  }

  [[nodiscard]] Point3 target_point(std::uint32_t source_vertex) const {
    return (1 / edge_) * target_.points[marker_of_.at(source_vertex)];
  }
  static void subtract(Eigen::MatrixXd& rhs, int row, double value, const Point3& point) {
    for (int axis = 0; axis < 3; ++axis) rhs(row, axis) -= value * point[static_cast<std::size_t>(axis)];
  }

  // The nearest place on the triangles around the nearest vertex that faces the same way.
  void add_closest(const std::vector<Point3>& places, double weight, Triplets& entries,
                   Eigen::MatrixXd& rhs) {
    const auto normals = point_normals({places, source_.triangles});
    for (std::uint32_t v = 0; v < places.size(); ++v) {
      const int r = row_[v];
      if (r < 0 || normals[v] == Point3{}) continue;
      const std::uint32_t near = tree_.find(places[v], options_.reach, [&](std::uint32_t i) {
        return dot(target_normals_[i], normals[v]) > 0;
      });
      if (near == NearestPoint::kNone) continue;
      entries.emplace_back(r, r, weight);
      subtract(rhs, r, -weight, (1 / edge_) * on_surface(places[v], near));
    }
  }

  [[nodiscard]] Point3 on_surface(const Point3& place, std::uint32_t near) const;

  const Surface &source_, &target_;
  const RegistrationOptions& options_;
  double edge_;  // mean edge: positions are divided by it
  NearestPoint tree_;
  std::vector<Point3> target_normals_;
  std::multimap<std::uint32_t, std::uint32_t> around_;  // triangles of each target vertex
  std::map<std::uint32_t, std::uint32_t> marker_of_;    // source vertex -> target vertex
  std::vector<int> row_;                                // [V + F] -1: a marker
  int num_rows_ = 0;
  std::vector<Tetrahedron> tetrahedra_;
  Triplets matrix_;
  std::vector<std::tuple<int, std::uint32_t, double>> to_markers_;
  std::vector<std::tuple<int, int, double>> identity_rhs_;
  std::vector<Point3> result_;
};

// Nearest place of a triangle (Ericson, Real-Time Collision Detection, section 5.1.5).
Point3 nearest_of_triangle(const Point3& p, const Point3& a, const Point3& b, const Point3& c) {
  const Point3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (const double vc = d1 * d4 - d3 * d2; vc <= 0 && d1 >= 0 && d3 <= 0) return a + (d1 / (d1 - d3)) * ab;
  if (d6 >= 0 && d5 <= d6) return c;
  if (const double vb = d5 * d2 - d1 * d6; vb <= 0 && d2 >= 0 && d6 <= 0) return a + (d2 / (d2 - d6)) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b);
  const double vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2, sum = va + vb + vc;
  return sum > 0 ? a + (vb / sum) * ab + (vc / sum) * ac : a;
}

Point3 Registration::on_surface(const Point3& place, std::uint32_t near) const {
  Point3 best = target_.points[near];
  double least = dot(best - place, best - place);
  const auto [first, last] = around_.equal_range(near);
  for (auto it = first; it != last; ++it) {
    const Triangle& t = target_.triangles[it->second];
    const Point3 q =
        nearest_of_triangle(place, target_.points[t[0]], target_.points[t[1]], target_.points[t[2]]);
    if (const double square = dot(q - place, q - place); square < least) least = square, best = q;
  }
  return best;
}

Status check_markers(const Surface& source, const Surface& target, std::span<const Marker> markers) {
  MIEN_TRY([[maybe_unused]] const auto there,
           check_markers_exist(markers, source.points.size(), target.points.size()));
  std::map<std::uint32_t, std::size_t> sources;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const Marker& m = markers[i];
    const std::string name = "marker " + std::to_string(i + 1);
    if (const auto [twin, is_new] = sources.emplace(m.source, i); !is_new)
      return Error{Errc::input, name,
                   "names the source vertex " + std::to_string(m.source) + " again, after marker " +
                       std::to_string(twin->second + 1),
                   "Give each vertex one place"};
  }
  return Done{};
}

double mean_edge(const Surface& surface) {
  double sum = 0;
  for (const Triangle& t : surface.triangles)
    for (std::size_t c = 0; c < 3; ++c) sum += norm(surface.points[t[c]] - surface.points[t[(c + 1) % 3]]);
  return surface.triangles.empty() ? 0 : sum / static_cast<double>(3 * surface.triangles.size());
}

}  // namespace

Status check_markers_exist(std::span<const Marker> markers, std::size_t num_source, std::size_t num_target) {
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const bool is_source = markers[i].source >= num_source;
    if (!is_source && markers[i].target < num_target) continue;
    return Error{Errc::input, "marker " + std::to_string(i + 1),
                 std::string("its ") + (is_source ? "source" : "target") + " vertex " +
                     std::to_string(is_source ? markers[i].source : markers[i].target) +
                     " does not exist: there are " + std::to_string(is_source ? num_source : num_target),
                 "Vertices are counted from 0; a pair is source,target"};
  }
  return Done{};
}

Result<std::vector<Point3>> register_surface(const Surface& source, const Surface& target,
                                             std::span<const Marker> markers,
                                             const RegistrationOptions& options, Progress& progress) {
  MIEN_TRY([[maybe_unused]] const auto checked, check_markers(source, target, markers));
  const double edge = mean_edge(source);
  if (!(edge > 0)) return Error{Errc::input, "source mesh", "has no triangles with area", ""};
  if (markers.empty()) return Error{Errc::input, "markers", "there are none", "Give at least four pairs"};
  Registration registration(source, target, markers, options, edge);
  progress.stage("registration", static_cast<std::int64_t>(options.closest.size()) + 1);
  std::vector<Point3> places;
  for (std::size_t pass = 0; pass <= options.closest.size(); ++pass) {
    if (progress.cancelled()) return Error{Errc::cancelled, "transfer", "interrupted", ""};
    if (!registration.solve(places, pass == 0 ? 0 : options.closest[pass - 1]))
      return Error{Errc::input, "source mesh", "a part of it is not held by any marker",
                   "Leave out its parts without markers, or add markers there"};
    places = registration.result();
    progress.update(static_cast<std::int64_t>(pass) + 1);
  }
  return places;
}

}  // namespace mien
