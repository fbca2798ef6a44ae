#include <algorithm>

#include "mien/transfer/surface.h"
#include "nearest.h"
#include "vectors.h"

namespace mien {
namespace {

constexpr double kTouch = 0.01;    // of the mean edge
constexpr double kContinue = 0.5;  // cosine of the normals: within 60 degrees

using Edge = std::array<std::uint32_t, 2>;

/// Sorted, as often as triangles have it.
std::vector<Edge> edges_of(const Surface& surface) {
  std::vector<Edge> edges;
  edges.reserve(3 * surface.triangles.size());
  for (const Triangle& t : surface.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax(t[i], t[(i + 1) % 3]);
      edges.push_back({a, b});
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Vertices of edges with a triangle on one side only, in rising order.
std::vector<std::uint32_t> border_of(std::span<const Edge> edges) {
  std::vector<std::uint32_t> border;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool as_before = i > 0 && edges[i] == edges[i - 1];
    const bool as_next = i + 1 < edges.size() && edges[i] == edges[i + 1];
    if (!as_before && !as_next) border.insert(border.end(), edges[i].begin(), edges[i].end());
  }
  std::sort(border.begin(), border.end());
  border.erase(std::unique(border.begin(), border.end()), border.end());
  return border;
}

}  // namespace

std::vector<Tie> touching_vertices(const Surface& surface) {
  const auto edges = edges_of(surface);
  if (edges.empty()) return {};
  double length = 0;
  for (const auto& [a, b] : edges) length += norm(surface.points[a] - surface.points[b]);
  const double reach = kTouch * length / static_cast<double>(edges.size());

  const auto border = border_of(edges);
  const auto normals = point_normals(surface);
  std::vector<Point3> places;
  places.reserve(border.size());
  for (const std::uint32_t v : border) places.push_back(surface.points[v]);
  const NearestPoint tree(places);
  std::vector<Tie> ties;
  for (std::size_t i = 0; i < border.size(); ++i) {
    const std::uint32_t v = border[i];
    // Of copies of one place each is tied to a smaller number, so that all hang together.
    const std::uint32_t found = tree.find(places[i], reach, [&](std::uint32_t k) {
      const std::uint32_t u = border[k];
      return u < v && dot(normals[u], normals[v]) > kContinue &&
             !std::binary_search(edges.begin(), edges.end(), Edge{u, v});
    });
    if (found != NearestPoint::kNone) ties.push_back({border[found], v});
  }
  return ties;
}

}  // namespace mien
