#include "mien/transfer/shape_transfer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "matrices.h"
#include "mien/base/contract.h"
#include "mien/base/parallel.h"
#include "nearest.h"

namespace mien {
namespace {

constexpr std::size_t kMinMarkers = 4;
constexpr double kSmallest = 1e-4;  // of a shape's largest offset: smaller ones are left out

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

SurfacePart part_of(const TransferMesh& mesh) {
  contract(mesh.mesh != nullptr, "transfer_shapes: a mesh is missing");
  const Surface whole = surface_of(*mesh.mesh);
  std::vector<bool> excluded = mesh.excluded;
  excluded.resize(whole.points.size());
  return part_without(whole, excluded);
}

// Markers in the numbers of the parts.
std::vector<Marker> markers_within(std::span<const Marker> markers, const SurfacePart& source,
                                   const SurfacePart& target, std::vector<std::string>& warnings) {
  const auto place = [](const std::vector<std::uint32_t>& whole, std::uint32_t v) {
    const auto found = std::lower_bound(whole.begin(), whole.end(), v);
    return found != whole.end() && *found == v ? static_cast<std::int64_t>(found - whole.begin()) : -1;
  };
  std::vector<Marker> within;
  std::size_t left_out = 0;
  for (const Marker& m : markers) {
    const std::int64_t s = place(source.whole, m.source), t = place(target.whole, m.target);
    if (s < 0 || t < 0)
      ++left_out;
    else
      within.push_back({static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(t)});
  }
  if (left_out > 0)
    warnings.push_back(std::to_string(left_out) + " of " + std::to_string(markers.size()) +
                       " markers lie on vertices that take no part");
  return within;
}

// Root mean square distance from the mean.
double spread_of(std::span<const Point3> points) {
  Point3 mean{};
  for (const Point3& p : points) mean = mean + (1.0 / static_cast<double>(points.size())) * p;
  double sum = 0;
  for (const Point3& p : points) sum += dot(p - mean, p - mean);
  return std::sqrt(sum / static_cast<double>(points.size()));
}

struct Fit {
  Similarity similarity;
  double reach = 0;
};

Result<Fit> fit_markers(const Surface& source, const Surface& target, std::span<const Marker> markers,
                        double reach) {
  if (markers.size() < kMinMarkers)
    return Error{Errc::input, "markers",
                 "there are " + std::to_string(markers.size()) + ", at least 4 are needed",
                 "Pair vertices of eyes, nose, mouth and jaw; all 68 landmarks are best"};
  std::vector<Point3> from, to;
  for (const Marker& m : markers) {
    from.push_back(source.points[m.source]);
    to.push_back(target.points[m.target]);
  }
  const double spread = spread_of(to);
  if (!(spread > 0)) return Error{Errc::input, "markers", "all of the target's lie at one place", ""};
  return Fit{best_similarity(from, to), reach > 0 ? reach : kReach * spread};
}

// Vertices that no pair and nothing near it reaches.
std::vector<std::uint32_t> far_vertices(const Surface& registered, const Surface& target,
                                        std::span<const TrianglePair> pairs, double reach) {
  std::vector<bool> is_near(target.points.size());
  for (const TrianglePair& pair : pairs)
    for (const std::uint32_t v : target.triangles[pair.target]) is_near[v] = true;
  const NearestPoint tree(registered.points);
  std::vector<std::uint32_t> far;
  for (std::uint32_t v = 0; v < target.points.size(); ++v)
    if (!is_near[v] &&
        tree.find(target.points[v], reach, [](std::uint32_t) { return true; }) == NearestPoint::kNone)
      far.push_back(v);
  return far;
}

// Every paired vertex, drawn towards where the source goes there.
class Anchors {
 public:
  Anchors(const Surface& source, const Surface& target, std::span<const TrianglePair> pairs, double weight)
      : source_(source), target_(target), pairs_(pairs), share_(target.points.size()) {
    for (const TrianglePair& pair : pairs)
      for (const std::uint32_t v : target.triangles[pair.target]) share_[v] += 1;
    for (std::uint32_t v = 0; v < share_.size(); ++v)
      if (share_[v] > 0) all_.push_back({v, weight});
  }
  [[nodiscard]] const std::vector<Anchor>& all() const { return all_; }
  [[nodiscard]] std::vector<Point3> places(std::span<const Point3> deformed) const {
    std::vector<Point3> sums(target_.points.size(), Point3{}), places;
    for (const TrianglePair& pair : pairs_) {
      Point3 offset{};
      for (const std::uint32_t v : source_.triangles[pair.source])
        offset = offset + (1.0 / 3) * (deformed[v] - source_.points[v]);
      for (const std::uint32_t v : target_.triangles[pair.target]) sums[v] = sums[v] + offset;
    }
    for (const Anchor& anchor : all_)
      places.push_back(target_.points[anchor.vertex] + (1 / share_[anchor.vertex]) * sums[anchor.vertex]);
    return places;
  }

 private:
  const Surface &source_, &target_;
  std::span<const TrianglePair> pairs_;
  std::vector<double> share_;  // [V] pairs around each vertex
  std::vector<Anchor> all_;
};

Blendshape sparse_shape(const std::string& name, const SurfacePart& target, std::span<const Point3> points,
                        double& largest) {
  largest = 0;
  for (std::size_t v = 0; v < points.size(); ++v)
    largest = std::max(largest, norm(points[v] - target.surface.points[v]));
  Blendshape shape{name, {}, {}, {}};
  for (std::size_t v = 0; v < points.size(); ++v) {
    const Point3 offset = points[v] - target.surface.points[v];
    if (!(norm(offset) > kSmallest * largest)) continue;
    shape.vertices.push_back(target.whole[v]);
    shape.offsets.push_back(
        {static_cast<float>(offset[0]), static_cast<float>(offset[1]), static_cast<float>(offset[2])});
  }
  return shape;
}

std::vector<double> distances_mm(const Surface& registered, const Surface& target) {
  const NearestPoint tree(target.points);
  std::vector<double> distances;
  for (const Point3& p : registered.points) {
    const auto near = tree.find(p, INFINITY, [](std::uint32_t) { return true; });
    distances.push_back(1000 * norm(target.points[near] - p));
  }
  return distances;
}

}  // namespace

Result<ShapeTransferResult> transfer_shapes(const TransferMesh& source_mesh,
                                            std::span<const Blendshape> shapes,
                                            const TransferMesh& target_mesh, std::span<const Marker> markers,
                                            const ShapeTransferOptions& options, Progress& progress) {
  Result<ShapeTransferResult> result{ShapeTransferResult{}};
  ShapeTransferReport& report = result->report;
  auto start = std::chrono::steady_clock::now();
  MIEN_TRY([[maybe_unused]] const auto there, check_markers_exist(markers, source_mesh.mesh->positions.size(),
                                                                  target_mesh.mesh->positions.size()));
  SurfacePart source = part_of(source_mesh);
  const SurfacePart target = part_of(target_mesh);
  if (source.surface.triangles.empty() || target.surface.triangles.empty())
    return Error{Errc::input, source.surface.triangles.empty() ? "source mesh" : "target mesh",
                 "has no triangles that take part", "Exclude less"};
  const auto pins = markers_within(markers, source, target, result.warnings);
  MIEN_TRY(const Fit fit, fit_markers(source.surface, target.surface, pins, options.registration.reach));
  report.similarity = fit.similarity;
  for (Point3& p : source.surface.points) p = fit.similarity(p);

  RegistrationOptions registration = options.registration;
  registration.reach = fit.reach;
  MIEN_TRY(std::vector<Point3> places,
           register_surface(source.surface, target.surface, pins, registration, progress));
  const Surface registered{std::move(places), source.surface.triangles};
  const auto pairs = pair_triangles(registered, target.surface, fit.reach);
  if (pairs.empty())
    return Error{Errc::incompatible, "transfer", "no triangles of source and target lie on each other",
                 "Check the markers and the units of the target"};
  report.distance_mm = distances_mm(registered, target.surface);
  report.registration_seconds = seconds_since(start);

  start = std::chrono::steady_clock::now();
  const auto held = far_vertices(registered, target.surface, pairs, kHeldReaches * fit.reach);
  const double steady = kAnchorReaches * fit.reach;
  const Anchors anchors(source.surface, target.surface, pairs, 2 / (steady * steady));
  const auto ties = touching_vertices(target.surface);
  MIEN_TRY(const DeformationTransfer solver,
           DeformationTransfer::create(target.surface, pairs, held, anchors.all(), ties));
  report.num_ties = ties.size();
  report.num_held = held.size() + target_mesh.mesh->positions.size() - target.whole.size();
  report.num_triangles = target.surface.triangles.size();
  std::vector<bool> is_paired(report.num_triangles);
  for (const TrianglePair& pair : pairs) is_paired[pair.target] = true;
  report.num_paired = static_cast<std::size_t>(std::count(is_paired.begin(), is_paired.end(), true));
  report.factor_seconds = seconds_since(start);

  start = std::chrono::steady_clock::now();
  progress.stage("shapes", 0);
  const std::size_t num_equations = pairs.size() + report.num_triangles - report.num_paired;
  std::vector<Blendshape> made(shapes.size());
  report.shapes.resize(shapes.size());
  parallel_for(options.num_threads, static_cast<std::int64_t>(shapes.size()), [&](std::int64_t i) {
    const Blendshape& shape = shapes[static_cast<std::size_t>(i)];
    TransferredShape& told = report.shapes[static_cast<std::size_t>(i)];
    told.name = shape.name;
    if (progress.cancelled()) return;
    std::vector<Point3> offsets(source_mesh.mesh->positions.size(), Point3{});
    for (std::size_t m = 0; m < shape.vertices.size(); ++m)
      offsets[shape.vertices[m]] = {shape.offsets[m].x, shape.offsets[m].y, shape.offsets[m].z};
    std::vector<Point3> deformed = source.surface.points;
    for (std::size_t v = 0; v < deformed.size(); ++v) {
      const Point3 offset = fit.similarity.scale * (fit.similarity.rotation * offsets[source.whole[v]]);
      told.source_mm = std::max(told.source_mm, 1000 * norm(offset));
      deformed[v] = deformed[v] + offset;
    }
    made[static_cast<std::size_t>(i)].name = shape.name;
    if (told.source_mm == 0) return;
    const auto moved =
        solver.transfer(deformation_gradients(source.surface, deformed), anchors.places(deformed));
    told.misfit = std::sqrt(moved.energy / static_cast<double>(num_equations));
    made[static_cast<std::size_t>(i)] = sparse_shape(shape.name, target, moved.points, told.target_mm);
    told.target_mm *= 1000;
  });
  if (progress.cancelled()) return Error{Errc::cancelled, "transfer", "interrupted", ""};
  std::string still;
  for (Blendshape& shape : made) {
    if (!shape.vertices.empty())
      result->shapes.push_back(std::move(shape));
    else
      still += (still.empty() ? "" : ", ") + shape.name;
  }
  if (!still.empty()) result.warnings.push_back("shapes that do not move the source: " + still);
  report.solve_seconds = seconds_since(start);
  return result;
}

}  // namespace mien
