#pragma once
#include <optional>
#include <span>
#include <string_view>

#include "mien/base/result.h"
#include "mien/core/character.h"
#include "mien/core/vector.h"

namespace mien {

/// A pinhole camera, metres. Nothing nearer than `near_m` is drawn.
struct Camera {
  Vec3 position{0, 0, 1};
  Vec3 target{0, 0, 0};
  Vec3 up{0, 1, 0};
  float vertical_fov_deg = 22;
  float near_m = 0.01f;
};

/// Where the camera stands; the character looks along +z and its left is +x.
enum class CameraView {
  front,
  portrait,       ///< turned a little, the view for videos
  three_quarter,  ///< 40 degrees from the character's left
  side,           ///< from the character's left
  mouth,          ///< close-up of the lips, from the front
};

/// "front", "portrait", "three-quarter", "side", "mouth". Errors (Errc::usage): another name.
Result<CameraView> parse_view(std::string_view name);
std::string_view view_name(CameraView view);

/// The smallest box around points, ignoring those that are not finite.
struct Bounds {
  Vec3 low, high;

  [[nodiscard]] Vec3 centre() const { return 0.5f * (low + high); }
  [[nodiscard]] Vec3 size() const { return high - low; }
};
/// Nothing when no point is finite.
std::optional<Bounds> bounds_of(std::span<const Vec3> points);

/// A camera that shows the box in full from `view` (for CameraView::mouth: from the front) in a picture of
/// `aspect` = width / height, with a little air around it.
Camera frame_bounds(const Bounds& bounds, CameraView view, double aspect);

/// A camera for a character at rest. All of it is in the picture, but the neck is cut some way below the
/// chin, so that the mesh's open end stays outside; the chin is known by "landmarks68", else by the shape
/// jawOpen. CameraView::mouth frames the region "lips", else the mouth landmarks, else what mouthPucker moves, else
/// the lower middle of the face. A character without a finite vertex gets a default camera.
Camera frame_character(const Character& character, CameraView view, double aspect);

}  // namespace mien
