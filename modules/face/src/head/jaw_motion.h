#pragma once
#include <optional>
#include <string_view>

#include "head/vec3d.h"

namespace mien::head {

/// Rotations by degrees about an axis through `centre`, right-handed: about x (+y towards +z), about y (+z
/// towards +x).
Vec3d rotated_about_x(Vec3d p, double degrees, Vec3d centre);
Vec3d rotated_about_y(Vec3d p, double degrees, Vec3d centre);

/// Rigid motion of the lower jaw.
struct JawMotion {
  double open_deg = 0;  ///< about the axis through the jaw joints
  double side_deg = 0;  ///< about a vertical axis, positive to the character's left
  Vec3d shift;          ///< cm

  /// Offset of a point that is fixed to the jaw.
  [[nodiscard]] Vec3d operator()(Vec3d p) const;
};

/// Motion of jawOpen, jawForward, jawLeft, jawRight; nothing for other shapes.
std::optional<JawMotion> jaw_motion(std::string_view shape);

}  // namespace mien::head
