#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mien/core/character.h"
#include "mien/core/vector.h"

namespace mien {

/// Angles of the head in degrees: yaw positive to the subject's left, pitch up, roll right ear down.
struct HeadAngles {
  float yaw_deg = 0, pitch_deg = 0, roll_deg = 0;
};

/// A rotation; rows of the matrix. The head rolls first, then nods, then turns: R = Ry(yaw) Rx(-pitch)
/// Rz(roll) with right-handed rotations about +x (left), +y (up), +z (front).
struct Rotation {
  std::array<Vec3, 3> rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  [[nodiscard]] Vec3 operator()(Vec3 v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
};
Rotation head_rotation(const HeadAngles& angles);
/// The same rotation as a unit quaternion x, y, z, w, with w >= 0.
std::array<float, 4> head_quaternion(const HeadAngles& angles);

/// The point that a head turns about: inside the neck, from the bounds of parts[0] (the middle of x, 30 % of
/// the height, 45 % of the depth). The origin for a character without vertices.
Vec3 neck_pivot(const Character& character);

/// One part of a character in a pose.
struct PosedPart {
  std::vector<Vec3> positions;  // [V] metres
  std::vector<Vec3> normals;    // [V] unit length, recomputed from the posed triangles
};
using PosedCharacter = std::vector<PosedPart>;  // one per part of the character

/// Applies frames of a Motion to a character: shapes by name, then the head's rotation about its pivot.
/// Coefficients are linear and unclamped; values that are not finite count as zero. Channels that no part
/// knows are ignored and listed.
class Poser {
 public:
  /// @param character  must outlive the poser
  /// @param channels   names of the values of every frame: shapes of the character (ARKit spellings are
  /// matched),
  ///                   headYaw, headPitch, headRoll
  Poser(const Character& character, std::span<const std::string> channels,
        std::optional<Vec3> pivot = std::nullopt);

  /// @param frame  [C] one value per channel @pre sizes agree
  /// @param out    resized as needed; reuse it from frame to frame
  void pose(std::span<const float> frame, PosedCharacter& out) const;

  /// Channels that move nothing.
  [[nodiscard]] const std::vector<std::string>& unused_channels() const { return unused_; }

 private:
  struct Use {
    std::size_t channel, part, shape;
  };
  const Character* character_;
  std::size_t num_channels_;
  std::vector<Use> uses_;
  std::array<std::optional<std::size_t>, 3> head_;  // channels of yaw, pitch, roll
  std::vector<std::string> unused_;
  Vec3 pivot_;
};

/// The character at rest, with normals.
PosedCharacter rest_pose(const Character& character);

}  // namespace mien
