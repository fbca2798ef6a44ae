#include <numbers>

#include "head/curves.h"
#include "head/parts.h"
#include "head/skin_surface.h"

namespace mien::head {
namespace {

// Radii of the vertex rings around the pupil, cm: dense where the colour changes.
constexpr std::array<double, 7> kWhiteRadii = {0.66, 0.70, 0.80, 0.95, 1.1, 1.2, 1.27};
constexpr double kPupilRadius = 0.25, kIrisRadius = 0.63, kLimbusRadius = 0.68;
constexpr Rgb kPupil = {0.015, 0.012, 0.012}, kLimbus = {0.10, 0.12, 0.14};
constexpr Rgb kInnerIris = {0.10, 0.22, 0.26}, kOuterIris = {0.16, 0.33, 0.42};

std::vector<double> ring_radii() {
  std::vector<double> radii = {0};
  for (const double r : linear_space(0.06, 0.235, 4)) radii.push_back(r);
  radii.push_back(0.26);
  for (const double r : linear_space(0.32, 0.62, 6)) radii.push_back(r);
  radii.insert(radii.end(), kWhiteRadii.begin(), kWhiteRadii.end());
  return radii;
}

Rgb color_at(double radius, double angle) {
  if (radius < kPupilRadius) return kPupil;
  if (radius < kIrisRadius) {
    const double streak = 0.55 + 0.45 * std::sin(angle * 14) * std::sin(radius * 30);
    const double f = (radius - kPupilRadius) / 0.38;
    const double shade = (0.85 + 0.25 * streak) * (1 - 0.5 * smooth_step(0.52, 0.62, radius));
    Rgb c{};
    for (std::size_t i = 0; i < 3; ++i) c[i] = (1.2 * (1 - f) * kInnerIris[i] + f * kOuterIris[i]) * shade;
    return c;
  }
  if (radius < kLimbusRadius) return kLimbus;
  const double f = smooth_step(0.7, 1.25, radius);  // the white reddens towards the lids
  return {0.86 - 0.10 * f, 0.83 - 0.22 * f, 0.80 - 0.22 * f};
}

}  // namespace

Part build_eyeball(BodySide side) {
  constexpr int kAround = 28;
  Part part;
  const auto radii = ring_radii();
  for (const double r : radii)
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround;
      part.positions.push_back({kEyeCentre.x * static_cast<int>(side) + r * std::cos(angle),
                                kEyeCentre.y + r * std::sin(angle),
                                kEyeCentre.z + std::sqrt(kEyeRadius * kEyeRadius - r * r)});
      part.colors.push_back(color_at(r, angle));
    }
  part.triangles = sheet_triangles(static_cast<int>(radii.size()), kAround, true);
  turn_around(part.triangles);
  return part;
}

}  // namespace mien::head
