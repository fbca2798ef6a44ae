#include "head/base_surface.h"

#include <algorithm>
#include <array>

#include "head/curves.h"

namespace mien::head {
namespace {

// One section of the head, cm. Heights differ in front, at the side and behind, so that one section follows
// the jaw line from the chin up to the jaw's angle and the nape.
struct Station {
  double front_z, front_y;  // profile of the face
  double side_x, side_y;    // widest point
  double middle_z;          // depth of the widest point
  double back_z, back_y;    // profile of the nape and the back of the head
  double roundness;         // exponent of the section: below 2 pointed, 2 elliptic, above 2 full
  double widening = 1;      // factor of side_x: the cheeks
};

constexpr std::array<Station, 18> kStations = {{
    {3.8, -15.5, 5.4, -15.5, -1.2, -6.4, -15.5, 2.10},        // 0: neck, cut
    {3.4, -12.6, 4.5, -11.8, -1.2, -6.0, -10.6, 2.10},        // 1
    {3.8, -10.2, 4.42, -8.2, -1.2, -6.2, -6.9, 2.10},         // 2: throat
    {6.0, -9.15, 4.90, -6.1, -0.8, -6.9, -4.7, 2.00, 1.02},   // 3: under the chin
    {7.75, -8.55, 5.18, -4.9, -0.3, -7.7, -3.3, 1.90, 1.04},  // 4: lowest point of the chin; jaw's angle
    {8.50, -7.5, 5.50, -3.9, 0.0, -8.4, -2.1, 1.86, 1.05},    // 5: front of the chin
    {8.62, -6.2, 5.82, -3.0, 0.1, -8.9, -1.1, 1.88, 1.05},    // 6: fold under the lower lip
    {8.80, -5.1, 6.08, -2.25, 0.1, -9.3, -0.2, 1.92, 1.05},   // 7
    {8.92, -4.15, 6.30, -1.55, 0.0, -9.6, 0.7, 1.96, 1.05},   // 8: mouth line
    {9.00, -3.2, 6.48, -0.85, -0.1, -9.9, 1.6, 2.00, 1.05},   // 9
    {9.00, -2.2, 6.64, -0.1, -0.2, -10.15, 2.5, 2.04, 1.05},  // 10: under the nose
    {8.95, 0.2, 6.90, 1.3, -0.4, -10.5, 3.9, 2.12, 1.04},     // 11
    {8.92, 2.75, 7.10, 2.95, -0.6, -10.6, 5.1, 2.18, 1.03},   // 12: eye line
    {9.02, 4.7, 7.25, 4.6, -0.8, -10.4, 6.3, 2.20, 1.02},     // 13: brow
    {8.72, 7.1, 7.25, 6.7, -0.9, -9.7, 7.9, 2.20},            // 14
    {7.25, 9.8, 6.45, 9.2, -0.9, -8.0, 10.0, 2.15},           // 15
    {4.35, 12.0, 4.25, 11.6, -0.9, -5.2, 12.0, 2.10},         // 16
    {-0.9, 13.1, 0.0, 13.1, -0.9, -0.9, 13.1, 2.00},          // 17: crown
}};

const NaturalSplines& profiles() {
  static const NaturalSplines splines = [] {
    std::vector<double> knots;
    std::vector<std::vector<double>> curves(8);
    for (std::size_t i = 0; i < kStations.size(); ++i) {
      const Station& s = kStations[i];
      knots.push_back(static_cast<double>(i));
      const std::array<double, 8> row = {
          s.front_z, s.front_y, s.side_x * s.widening, s.side_y, s.middle_z, s.back_z, s.back_y, s.roundness};
      for (std::size_t c = 0; c < row.size(); ++c) curves[c].push_back(row[c]);
    }
    return NaturalSplines(std::move(knots), std::move(curves));
  }();
  return splines;
}

// Station whose front profile lies at height y, roughly: where the search begins.
double guess_station(double y) {
  static const auto table = [] {
    std::array<std::vector<double>, 2> t;  // heights, stations, from under the chin up
    for (std::size_t i = 3; i < 17; ++i) {
      t[0].push_back(kStations[i].front_y);
      t[1].push_back(static_cast<double>(i));
    }
    return t;
  }();
  return interpolate(y, table[0], table[1]);
}

}  // namespace

Vec3d base_point(ChartPoint at) {
  constexpr double kTiny = 1e-6;  // keeps the crown's radii above zero
  std::array<double, 8> p;
  profiles().evaluate(std::clamp(at.station, 0.0, kLastStation), p);
  const auto [front_z, front_y, side_x, side_y, middle_z, back_z, back_y, roundness] = p;
  const double s = std::sin(at.azimuth), c = std::cos(at.azimuth);
  const bool front = c >= 0;
  const double depth = std::max(front ? front_z - middle_z : middle_z - back_z, kTiny);
  const double width = std::max(side_x, kTiny);
  const double sum = std::pow(std::abs(c) / depth, roundness) + std::pow(std::abs(s) / width, roundness);
  const double radius = std::pow(sum, -1 / roundness);
  return {radius * s, (front ? front_y : back_y) * c * c + side_y * s * s, middle_z + radius * c};
}

ChartPoint find_in_front(double x, double y) {
  constexpr int kSteps = 40;
  constexpr double kDifference = 1e-4, kMaxAzimuthStep = 0.2, kMaxStationStep = 0.5;
  ChartPoint at{std::asin(std::clamp(x / 9.0, -0.95, 0.95)), guess_station(y)};
  for (int step = 0; step < kSteps; ++step) {
    const Vec3d p = base_point(at);
    const Vec3d pa = base_point({at.azimuth + kDifference, at.station});
    const Vec3d ps = base_point({at.azimuth, at.station + kDifference});
    // Jacobian [a b; c d] of (x, y) by (azimuth, station).
    const double a = (pa.x - p.x) / kDifference, b = (ps.x - p.x) / kDifference;
    const double c = (pa.y - p.y) / kDifference, d = (ps.y - p.y) / kDifference;
    const double rx = x - p.x, ry = y - p.y, det = a * d - b * c;
    at.azimuth += std::clamp((d * rx - b * ry) / det, -kMaxAzimuthStep, kMaxAzimuthStep);
    at.station += std::clamp((a * ry - c * rx) / det, -kMaxStationStep, kMaxStationStep);
  }
  return at;
}

}  // namespace mien::head
