#include "mien/render/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

namespace mien {
namespace {

struct NamedView {
  CameraView view;
  std::string_view name;
  double azimuth_deg;    // of the camera, towards the character's left
  double elevation_deg;  // of the camera
};
constexpr std::array<NamedView, 5> kViews = {{{CameraView::front, "front", 0, 0},
                                              {CameraView::portrait, "portrait", 14, 2},
                                              {CameraView::three_quarter, "three-quarter", 40, 2},
                                              {CameraView::side, "side", 90, 0},
                                              {CameraView::mouth, "mouth", 0, 0}}};

const NamedView& entry(CameraView view) {
  return *std::find_if(kViews.begin(), kViews.end(), [view](const NamedView& v) { return v.view == view; });
}

constexpr double kAir = 1.04;          // of the picture's height or width
constexpr double kMouthAir = 2.1;      // the close-up shows chin and nose as well
constexpr float kNeckPerFace = 0.42f;  // neck shown below the chin, in heights chin to nose bridge
constexpr float kFacePerHead = 0.55f;  // chin to nose bridge, in heights chin to crown
constexpr std::size_t kChinLandmark = 8, kNoseBridgeLandmark = 27, kFirstMouthLandmark = 48,
                      kNumLandmarks = 68;

// Looks at the points from `view`, as near as their perspective allows. With `sits_on_border` they end at the
// lower border of the picture even where its width decides the distance, else they stand in the middle.
Camera camera_towards(std::span<const Vec3> points, CameraView view, double aspect, double air,
                      bool sits_on_border) {
  const NamedView& v = entry(view);
  const double azimuth = v.azimuth_deg * std::numbers::pi / 180,
               elevation = v.elevation_deg * std::numbers::pi / 180;
  const auto vec = [](double x, double y, double z) {
    return Vec3{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  };
  const Vec3 back = vec(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                        std::cos(azimuth) * std::cos(elevation));
  const Vec3 right = vec(std::cos(azimuth), 0, -std::sin(azimuth));
  const Vec3 up = cross(back, right);
  std::vector<Vec3> turned;
  for (const Vec3& p : points) turned.push_back({dot(p, right), dot(p, up), dot(p, back)});
  const auto box = bounds_of(turned);
  Camera camera;
  if (!box) return camera;
  const float tangent =
      static_cast<float>(std::tan(camera.vertical_fov_deg * std::numbers::pi / 360) / std::max(air, 1.0));
  const float wide_tangent = tangent * static_cast<float>(aspect);
  Vec3 centre = box->centre();
  // A point at (r, u, b) from the centre is inside when |r| <= (distance - b) wide_tangent, and so for u.
  float distance = 1e-3f;
  for (const Vec3& p : turned) {
    const Vec3 q = p - centre;
    const float needed = q.z + std::max(std::abs(q.x) / wide_tangent, std::abs(q.y) / tangent);
    if (needed > distance) distance = needed;  // false for a point that is not a number
  }
  if (sits_on_border) centre.y = std::max(centre.y, box->low.y + tangent * distance);
  camera.target = centre.x * right + centre.y * up + centre.z * back;
  camera.position = camera.target + distance * back;
  camera.near_m = 0.02f * distance;
  return camera;
}

std::array<Vec3, 8> corners_of(const Bounds& b) {
  std::array<Vec3, 8> corners;
  for (unsigned i = 0; i < 8; ++i)
    corners[i] = {(i & 1) != 0 ? b.high.x : b.low.x, (i & 2) != 0 ? b.high.y : b.low.y,
                  (i & 4) != 0 ? b.high.z : b.low.z};
  return corners;
}

std::vector<Vec3> points_of(const Mesh& mesh, std::span<const std::uint32_t> vertices) {
  std::vector<Vec3> points;
  for (const std::uint32_t v : vertices)
    if (v < mesh.positions.size()) points.push_back(mesh.positions[v]);
  return points;
}

std::vector<Vec3> region_points(const Character& character, const std::string& region) {
  const auto found = character.regions.find(region);
  if (found == character.regions.end() || character.parts.empty()) return {};
  return points_of(character.parts[0].mesh, found->second);
}

// Vertices of the skin that a shape moves by at least `share` of its largest offset. Tells where the mouth
// and the chin are on a character without tables.
std::vector<Vec3> moved_points(const CharacterPart& skin, std::string_view shape, float share) {
  std::vector<std::uint32_t> moved;
  for (const Blendshape& candidate : skin.shapes) {
    if (candidate.name != shape) continue;
    float largest = 0;
    for (const Vec3& d : candidate.offsets) largest = std::max(largest, length(d));
    for (std::size_t i = 0; i < candidate.offsets.size(); ++i)
      if (largest > 0 && length(candidate.offsets[i]) >= share * largest)
        moved.push_back(candidate.vertices[i]);
  }
  return points_of(skin.mesh, moved);
}

std::vector<Vec3> mouth_points(const Character& character, const Bounds& skin) {
  std::vector<Vec3> points = region_points(character, "lips");
  if (!points.empty()) return points;
  points = region_points(character, "landmarks68");
  if (points.size() == kNumLandmarks) return {points.begin() + kFirstMouthLandmark, points.end()};
  points = moved_points(character.parts[0], "mouthPucker", 0.8f);
  if (!points.empty()) return points;
  // The lower middle of the face.
  const Vec3 size = skin.size(), centre = skin.centre();
  return {{centre.x - 0.2f * size.x, skin.low.y + 0.2f * size.y, skin.high.z},
          {centre.x + 0.2f * size.x, skin.low.y + 0.36f * size.y, skin.high.z}};
}

struct Neck {
  float chin;  // height of the chin
  float cut;   // where the picture may end: some way down the neck
};

// Nothing when it is not known where the chin is, or when the mesh ends above the cut.
std::optional<Neck> find_neck(const Character& character, const Bounds& skin) {
  float chin = 0, face = 0;
  const std::vector<Vec3> landmarks = region_points(character, "landmarks68");
  if (landmarks.size() == kNumLandmarks) {
    chin = landmarks[kChinLandmark].y;
    face = landmarks[kNoseBridgeLandmark].y - chin;
  } else {
    const auto jaw = bounds_of(moved_points(character.parts[0], "jawOpen", 0.6f));
    if (!jaw) return std::nullopt;
    chin = jaw->low.y;
    face = kFacePerHead * (skin.high.y - chin);
  }
  const float cut = chin - kNeckPerFace * face;
  if (cut < chin && cut > skin.low.y) return Neck{chin, cut};
  return std::nullopt;
}

}  // namespace

Result<CameraView> parse_view(std::string_view name) {
  std::string names;
  for (const NamedView& v : kViews) {
    if (v.name == name) return v.view;
    names += (names.empty() ? "" : ", ") + std::string(v.name);
  }
  return Error{Errc::usage, "view '" + std::string(name) + "'", "is not known", "Choose one of: " + names};
}

std::string_view view_name(CameraView view) { return entry(view).name; }

std::optional<Bounds> bounds_of(std::span<const Vec3> points) {
  std::optional<Bounds> box;
  for (const Vec3& p : points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) continue;
    if (!box) box = Bounds{p, p};
    box->low = {std::min(box->low.x, p.x), std::min(box->low.y, p.y), std::min(box->low.z, p.z)};
    box->high = {std::max(box->high.x, p.x), std::max(box->high.y, p.y), std::max(box->high.z, p.z)};
  }
  return box;
}

Camera frame_bounds(const Bounds& bounds, CameraView view, double aspect) {
  return camera_towards(corners_of(bounds), view, aspect, kAir, false);
}

Camera frame_character(const Character& character, CameraView view, double aspect) {
  if (character.parts.empty()) return {};
  const auto skin = bounds_of(character.parts[0].mesh.positions);
  if (!skin) return {};
  if (view == CameraView::mouth)
    return camera_towards(mouth_points(character, *skin), view, aspect, kMouthAir, false);
  std::vector<Vec3> all;
  for (const CharacterPart& part : character.parts)
    all.insert(all.end(), part.mesh.positions.begin(), part.mesh.positions.end());
  const std::optional<Neck> neck = find_neck(character, *skin);
  if (!neck) return camera_towards(all, view, aspect, kAir, false);
  const auto is_head = [&](const Vec3& p) { return p.y >= neck->chin; };
  std::vector<Vec3> shown;
  std::copy_if(all.begin(), all.end(), std::back_inserter(shown), is_head);
  const auto head = bounds_of(shown);
  if (!head) return camera_towards(all, view, aspect, kAir, false);
  for (const Vec3& p : all)  // shoulders do not make the picture wider
    if (!is_head(p) && p.y >= neck->cut)
      shown.push_back(
          {std::clamp(p.x, head->low.x, head->high.x), p.y, std::clamp(p.z, head->low.z, head->high.z)});
  return camera_towards(shown, view, aspect, kAir, true);
}

}  // namespace mien
