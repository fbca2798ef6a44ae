#include "head/jaw_motion.h"

#include <numbers>

namespace mien::head {
namespace {

constexpr Vec3d kJointAxis{0, -0.4, 0.2};  // between the two jaw joints
constexpr Vec3d kSideAxis{0, 0, -0.5};

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace

Vec3d rotated_about_x(Vec3d p, double degrees, Vec3d centre) {
  const double c = std::cos(radians(degrees)), s = std::sin(radians(degrees));
  const Vec3d q = p - centre;
  return Vec3d{q.x, c * q.y - s * q.z, s * q.y + c * q.z} + centre;
}

Vec3d rotated_about_y(Vec3d p, double degrees, Vec3d centre) {
  const double c = std::cos(radians(degrees)), s = std::sin(radians(degrees));
  const Vec3d q = p - centre;
  return Vec3d{c * q.x + s * q.z, q.y, c * q.z - s * q.x} + centre;
}

Vec3d JawMotion::operator()(Vec3d p) const {
  return rotated_about_y(rotated_about_x(p, open_deg, kJointAxis), side_deg, kSideAxis) - p + shift;
}

std::optional<JawMotion> jaw_motion(std::string_view shape) {
  if (shape == "jawOpen") return JawMotion{20, 0, {0, -0.10, 0.12}};
  if (shape == "jawForward") return JawMotion{0, 0, {0, -0.05, 0.75}};
  if (shape == "jawLeft") return JawMotion{0, 4.2, {}};
  if (shape == "jawRight") return JawMotion{0, -4.2, {}};
  return std::nullopt;
}

}  // namespace mien::head
