#include "head/features.h"

#include <algorithm>
#include <array>

#include "head/curves.h"

namespace mien::head {
namespace {

struct Feature {
  double amount;  // cm
  Bump shape;
};

// Hills and hollows along z.
constexpr std::array<Feature, 15> kForward = {{
    {0.26, {0, -0.75, 0.60, 0.55}},                // tip of the nose
    {0.66, {0.98, -1.30, 0.42, 0.46, 2.4, true}},  // wing of the nose
    {-0.12, {1.52, -1.4, 0.20, 0.55, 2, true}},    // groove beside the wing
    {0.24, {2.6, 4.45, 2.0, 0.8, 2, true}},        // brow ridge
    {0.10, {0, 4.6, 1.2, 0.9}},                    // between the brows
    {-0.50, {1.72, 2.9, 0.75, 0.9, 2, true}},      // inner corner of the eye socket
    {-0.42, {3.25, 2.75, 1.8, 1.25, 2.4, true}},   // eye socket
    {0.46, {3.6, -0.45, 1.8, 1.5, 2, true}},       // apple of the cheek
    {-0.16, {2.9, -2.9, 0.8, 1.1, 2, true}},       // fold from nose to mouth
    {0.55, {0, -4.1, 2.6, 1.7}},                   // muzzle
    {-0.09, {0, -2.75, 0.26, 0.5}},                // philtrum
    {0.05, {0.42, -2.8, 0.22, 0.5, 2, true}},      // ridge of the philtrum
    {-0.26, {0, -5.95, 1.8, 0.55}},                // fold under the lower lip
    {0.46, {0, -7.45, 1.35, 1.0}},                 // chin
    {0.12, {0, 7.2, 3.5, 1.8}},                    // forehead
}};

// Hills and hollows away from the vertical axis.
constexpr std::array<Feature, 3> kOutward = {{
    {0.20, {5.7, 0.7, 1.5, 1.3, 2, true}},    // cheekbone
    {-0.22, {6.7, 4.4, 1.3, 1.7, 2, true}},   // temple
    {-0.16, {4.9, -3.4, 1.3, 1.6, 2, true}},  // hollow of the cheek
}};

// Ridge of the nose: height and width of its profile between the upper lip and the forehead.
constexpr double kRidgeLow = -2.9, kRidgeHigh = 5.2;

double ridge(double x, double y) {
  static const MonotoneCurve height(
      {kRidgeLow, -2.45, -2.15, -1.85, -1.5, -1.15, -0.7, -0.2, 0.5, 1.5, 2.5, 3.4, 4.2, kRidgeHigh},
      {0, 0.02, 0.12, 0.55, 1.25, 1.68, 1.86, 1.72, 1.38, 0.98, 0.66, 0.42, 0.22, 0});
  static const MonotoneCurve width({kRidgeLow, -2.2, -1.6, -1.0, -0.4, 0.5, 1.5, 2.5, 3.4, kRidgeHigh},
                                   {1.2, 1.0, 0.95, 0.92, 0.86, 0.80, 0.76, 0.76, 0.9, 1.4});
  if (y <= kRidgeLow || y >= kRidgeHigh) return 0;
  const double u = std::abs(x) / width(y);
  return height(y) * std::exp(-1.15 * u * u);
}

}  // namespace

double bump(double x, double y, const Bump& b) {
  const double u = ((b.both_sides ? std::abs(x) : x) - b.cx) / b.rx, v = (y - b.cy) / b.ry;
  return std::exp(-std::pow(u * u + v * v, b.power / 2));
}

Vec3d add_features(Vec3d base, double azimuth) {
  const double front = smooth_step(-0.5, 3.0, base.z);
  double forward = ridge(base.x, base.y), outward = 0;
  for (const Feature& f : kForward) forward += f.amount * bump(base.x, base.y, f.shape);
  for (const Feature& f : kOutward) outward += f.amount * bump(base.x, base.y, f.shape);
  return {base.x + front * outward * std::sin(azimuth), base.y,
          base.z + front * forward + front * outward * std::cos(azimuth)};
}

}  // namespace mien::head
