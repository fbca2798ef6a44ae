#include "mien/metrics/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mien/base/contract.h"
#include "mien/base/parallel.h"
#include "undefined.h"

namespace mien {
namespace {

constexpr std::uint32_t kLeafSize = 4;
constexpr double kSlack =
    1 - 1e-12;  // the bound of a box may be rounded up, and must not hide a nearer triangle

using Point = std::array<double, 3>;

Point wide(Vec3 v) { return {v.x, v.y, v.z}; }
Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point operator+(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Point operator*(double s, const Point& a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double square(const Point& a) { return dot(a, a); }

double squared_to_segment(const Point& p, const Point& a, const Point& b) {
  const Point ab = b - a;
  const double size = square(ab);
  const double t = size > 0 ? std::clamp(dot(p - a, ab) / size, 0.0, 1.0) : 0.0;
  return square(p - (a + t * ab));
}

// Closest point by the region of the triangle's plane that the point projects into (Ericson, "Real-Time
// Collision Detection", 2005, section 5.1.5).
double squared_to_triangle(const Point& p, const Point& a, const Point& b, const Point& c) {
  const Point ab = b - a, ac = c - a, ap = p - a;
  const Point normal = {ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                        ab[0] * ac[1] - ab[1] * ac[0]};
  if (!(square(normal) > 0))  // a line or a point
    return std::min({squared_to_segment(p, a, b), squared_to_segment(p, b, c), squared_to_segment(p, c, a)});
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return square(ap);
  const Point bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return square(bp);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return squared_to_segment(p, a, b);
  const Point cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return square(cp);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return squared_to_segment(p, a, c);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return squared_to_segment(p, b, c);
  const double sum = va + vb + vc;
  return square(p - (a + (vb / sum) * ab + (vc / sum) * ac));
}

}  // namespace

double triangle_distance(Vec3 point, Vec3 a, Vec3 b, Vec3 c) {
  return std::sqrt(squared_to_triangle(wide(point), wide(a), wide(b), wide(c)));
}

TriangleTree::TriangleTree(std::span<const Vec3> positions, std::span<const Triangle> triangles)
    : positions_(positions.begin(), positions.end()), triangles_(triangles.begin(), triangles.end()) {
  contract(!triangles.empty(), "TriangleTree: at least one triangle expected");
  for (const auto& triangle : triangles_)
    for (const std::uint32_t v : triangle)
      contract(v < positions_.size(), "TriangleTree: a triangle names a vertex that does not exist");
  nodes_.reserve(2 * triangles_.size());
  build(0, static_cast<std::uint32_t>(triangles_.size()));
  move(positions);
}

// Halves the triangles along the axis in which their middles are spread most.
std::uint32_t TriangleTree::build(std::uint32_t first, std::uint32_t count) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({{}, {}, first, count});
  if (count <= kLeafSize) return index;
  const auto middle = [this](const Triangle& t) {
    return wide(positions_[t[0]]) + wide(positions_[t[1]]) + wide(positions_[t[2]]);
  };
  Point low, high;
  low.fill(std::numeric_limits<double>::infinity()), high.fill(-std::numeric_limits<double>::infinity());
  for (std::uint32_t i = first; i < first + count; ++i) {
    const Point m = middle(triangles_[i]);
    for (std::size_t k = 0; k < 3; ++k) low[k] = std::min(low[k], m[k]), high[k] = std::max(high[k], m[k]);
  }
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  const auto begin = triangles_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count,
                   [&](const Triangle& a, const Triangle& b) { return middle(a)[axis] < middle(b)[axis]; });
  build(first, count / 2);
  const std::uint32_t second = build(first + count / 2, count - count / 2);
  nodes_[index].first = second;
  nodes_[index].count = 0;
  return index;
}

void TriangleTree::move(std::span<const Vec3> positions) {
  contract(positions.size() == positions_.size(), "TriangleTree: as many positions expected");
  std::copy(positions.begin(), positions.end(), positions_.begin());
  for (std::size_t i = nodes_.size(); i-- > 0;)
    fit(static_cast<std::uint32_t>(i));  // children before parents
}

void TriangleTree::fit(std::uint32_t index) {
  Node& node = nodes_[index];
  node.low.fill(std::numeric_limits<double>::infinity());
  node.high.fill(-std::numeric_limits<double>::infinity());
  const auto hold = [&](const Point& low, const Point& high) {
    for (std::size_t k = 0; k < 3; ++k)
      node.low[k] = std::min(node.low[k], low[k]), node.high[k] = std::max(node.high[k], high[k]);
  };
  if (node.count == 0) {
    for (const std::uint32_t child : {index + 1, node.first}) hold(nodes_[child].low, nodes_[child].high);
    return;
  }
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
    for (const std::uint32_t v : triangles_[i]) hold(wide(positions_[v]), wide(positions_[v]));
}

double TriangleTree::distance(Vec3 point) const {
  const Point p = wide(point);
  const auto bound = [&](const Node& node) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d = std::max({node.low[k] - p[k], 0.0, p[k] - node.high[k]});
      sum += d * d;
    }
    return sum * kSlack;
  };
  struct Waiting {
    std::uint32_t node;
    double bound;
  };
  std::array<Waiting, 128> stack;  // halving 2^32 triangles needs 64
  std::size_t depth = 0;
  stack[depth++] = {0, bound(nodes_[0])};
  double best = std::numeric_limits<double>::infinity();
  while (depth > 0) {
    const auto [index, nearest] = stack[--depth];
    if (nearest >= best) continue;
    const Node& node = nodes_[index];
    if (node.count == 0) {
      Waiting a{index + 1, bound(nodes_[index + 1])}, b{node.first, bound(nodes_[node.first])};
      if (a.bound < b.bound) std::swap(a, b);
      stack[depth++] = a, stack[depth++] = b;  // the nearer one is looked at first
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Triangle& t = triangles_[i];
      best = std::min(best, squared_to_triangle(p, wide(positions_[t[0]]), wide(positions_[t[1]]),
                                                wide(positions_[t[2]])));
    }
  }
  return std::sqrt(best);
}

Result<double> surface_distance(const Motion& truth, const Motion& predicted,
                                std::span<const TriangleTree::Triangle> triangles, int num_threads) {
  const auto fail = [](std::string why) {
    return Error{Errc::incompatible, "surface distance", std::move(why), ""};
  };
  if (truth.space != MotionSpace::vertices || predicted.space != MotionSpace::vertices ||
      truth.topology.num_vertices != predicted.topology.num_vertices)
    return fail("truth and prediction are not motions of the same vertices");
  if (triangles.empty()) return fail("the mesh has no triangles");
  const auto num_vertices = static_cast<std::size_t>(truth.topology.num_vertices);
  for (const auto& triangle : triangles)
    for (const std::uint32_t v : triangle)
      if (v >= num_vertices)
        return fail("a triangle names vertex " + std::to_string(v) + " of " + std::to_string(num_vertices));
  const std::int64_t num_frames = std::min(truth.num_frames(), predicted.num_frames());
  if (num_frames == 0) return kNan;

  std::vector<Vec3> first(num_vertices);
  copy_positions(truth, 0, first);
  const TriangleTree shape(first, triangles);
  std::vector<double> means(static_cast<std::size_t>(num_frames));
  constexpr std::int64_t kBlock = 8;  // frames that share one copy of the tree
  parallel_for(num_threads, (num_frames + kBlock - 1) / kBlock, [&](std::int64_t block) {
    TriangleTree tree = shape;
    std::vector<Vec3> points(num_vertices);
    for (std::int64_t n = block * kBlock; n < std::min(num_frames, (block + 1) * kBlock); ++n) {
      copy_positions(truth, n, points);
      tree.move(points);
      copy_positions(predicted, n, points);
      double sum = 0;
      for (const Vec3& point : points) sum += tree.distance(point);
      means[static_cast<std::size_t>(n)] = sum / static_cast<double>(num_vertices);
    }
  });
  double sum = 0;
  for (const double m : means) sum += m;
  return sum / static_cast<double>(num_frames);
}

}  // namespace mien
