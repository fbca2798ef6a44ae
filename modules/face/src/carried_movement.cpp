#include "mien/face/carried_movement.h"

#include <string>

namespace mien {
namespace {

Vec3 with_y_up(Vec3 p) { return {p.x, p.z, -p.y}; }

}  // namespace

Result<Motion> carry_movement(Motion vertices, std::span<const float> neutral, const Mesh& face) {
  const auto fail = [](std::string why) {
    return Error{Errc::incompatible, "movement to carry", std::move(why), ""};
  };
  if (vertices.space != MotionSpace::vertices) return fail("is not one of vertices");
  const auto width = static_cast<std::size_t>(vertices.num_channels());
  if (neutral.size() != width || 3 * face.positions.size() != width)
    return fail("is of " + std::to_string(width / 3) + " vertices, its neutral face has " +
                std::to_string(neutral.size() / 3) + " and the other face " +
                std::to_string(face.positions.size()));
  for (std::int64_t n = 0; n < vertices.num_frames(); ++n) {
    const auto frame = vertices.frame(n);
    for (std::size_t v = 0; v < face.positions.size(); ++v) {
      const Vec3 own = face.positions[v];
      const float place[] = {own.x, own.y, own.z};
      for (std::size_t i = 0; i < 3; ++i) {
        float& value = frame[3 * v + i];
        value = static_cast<float>(static_cast<double>(place[i]) + static_cast<double>(value) -
                                   static_cast<double>(neutral[3 * v + i]));
      }
    }
  }
  return vertices;
}

void turn_z_up(Mesh& mesh) {
  for (Vec3& p : mesh.positions) p = with_y_up(p);
  for (Vec3& n : mesh.normals) n = with_y_up(n);
}

}  // namespace mien
