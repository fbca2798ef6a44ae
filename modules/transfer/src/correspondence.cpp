#include <algorithm>

#include "mien/transfer/registration.h"
#include "nearest.h"
#include "vectors.h"

namespace mien {

namespace {

// Around thin folds like lips and lids the nearest triangle may be the other side's: one that faces nearly
// the same way comes first.
constexpr double kAlike = 0.7;

std::uint32_t partner(const NearestPoint& centres, std::span<const Point3> normals, const Point3& centre,
                      const Point3& normal, double reach) {
  for (const double least : {kAlike, 0.0}) {
    const std::uint32_t found =
        centres.find(centre, reach, [&](std::uint32_t i) { return dot(normals[i], normal) > least; });
    if (found != NearestPoint::kNone) return found;
  }
  return NearestPoint::kNone;
}

}  // namespace

std::vector<TrianglePair> pair_triangles(const Surface& registered, const Surface& target, double reach) {
  const auto source_centres = centroids(registered), target_centres = centroids(target);
  const auto source_normals = triangle_normals(registered), target_normals = triangle_normals(target);
  const NearestPoint sources(source_centres), targets(target_centres);
  std::vector<TrianglePair> pairs;
  for (std::uint32_t s = 0; s < source_centres.size(); ++s)
    if (const auto t = partner(targets, target_normals, source_centres[s], source_normals[s], reach);
        t != NearestPoint::kNone)
      pairs.push_back({s, t});
  for (std::uint32_t t = 0; t < target_centres.size(); ++t)
    if (const auto s = partner(sources, source_normals, target_centres[t], target_normals[t], reach);
        s != NearestPoint::kNone)
      pairs.push_back({s, t});
  std::sort(pairs.begin(), pairs.end(), [](const TrianglePair& a, const TrianglePair& b) {
    return a.target != b.target ? a.target < b.target : a.source < b.source;
  });
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace mien
