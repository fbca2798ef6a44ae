#include <algorithm>
#include <numbers>

#include "head/curves.h"
#include "head/features.h"
#include "head/parts.h"

namespace mien::head {
namespace {

constexpr double kFirstStation = 0.8, kLastRowStation = 16.95;

// Height at which the hair begins, cm; the table runs from the forehead to the nape, with the sideburn
// at 1.47 rad.
double hairline(double azimuth) {
  static const MonotoneCurve height({0, 0.35, 0.7, 0.95, 1.15, 1.33, 1.47, 1.62, 1.85, 2.2, 3.2},
                                    {8.6, 8.5, 7.9, 6.4, 4.3, 2.0, 0.9, 3.6, 1.0, -3.4, -5.2});
  const double away = std::abs(azimuth);
  const double parting = 0.35 * std::sin(2.2 * azimuth) * gauss(away, 0, 0.7);
  return parting + height(std::clamp(away, 0.0, 3.2));
}

// Station at which the base surface reaches the hairline.
double hairline_station(double azimuth) {
  constexpr int kSamples = 900;
  const auto stations = linear_space(kFirstStation, 16.9, kSamples);
  std::vector<double> heights;
  for (const double t : stations) heights.push_back(base_point({azimuth, t}).y);
  return interpolate(hairline(azimuth), heights, stations);
}

// Thickness above the scalp at v in 0 (hairline) ... 1 (crown), cm.
double thickness(double azimuth, double v) {
  const double strand = 0.10 * std::sin(azimuth * 21 + 6 * v + 2.2 * std::sin(3 * azimuth)) +
                        0.05 * std::sin(azimuth * 47 + 9 * v);
  const double quiff = 0.25 * gauss(azimuth, 0.35, 0.8) * gauss(v, 0.10, 0.14);
  double body = (0.55 + 0.45 * smooth_step(0, 0.35, v) + quiff) * std::sqrt(std::clamp(v / 0.10, 0.0, 1.0));
  const double fringe = 1 + 0.25 * gauss(azimuth, 0, 0.9) * gauss(v, 0.25, 0.3);
  const double sideburn = 1 - 0.45 * gauss(std::abs(azimuth), 1.45, 0.28) * (1 - v) * (1 - v);
  body *= fringe * sideburn;
  return -0.12 + body + strand * std::clamp(v / 0.15, 0.0, 1.0) * (1 - v * v * v * v);
}

}  // namespace

Part build_hair() {
  constexpr int kAround = 120, kRows = 34;
  constexpr double kDifference = 1e-2;
  constexpr Rgb kColor = {0.15, 0.095, 0.065};
  std::vector<double> azimuths, first_stations;
  for (int k = 0; k < kAround; ++k) {
    azimuths.push_back(-std::numbers::pi + 2 * std::numbers::pi * k / kAround);
    first_stations.push_back(hairline_station(azimuths.back()));
  }
  Part part;
  for (const double v : linear_space(0, 1, kRows))
    for (std::size_t k = 0; k < azimuths.size(); ++k) {
      const ChartPoint at{azimuths[k], first_stations[k] * (1 - v) + kLastRowStation * v};
      const Vec3d base = base_point(at);
      const Vec3d n = cross(base_point({at.azimuth + kDifference, at.station}) - base,
                            base_point({at.azimuth, at.station + kDifference}) - base);
      part.positions.push_back(add_features(base, at.azimuth) +
                               (thickness(at.azimuth, v) / (length(n) + 1e-12)) * n);
    }
  part.triangles = sheet_triangles(kRows, kAround, true);
  const auto crown = static_cast<std::uint32_t>(part.positions.size());
  part.positions.push_back({0, 14.0, -0.9});
  for (std::uint32_t k = 0; k < kAround; ++k)
    part.triangles.push_back({crown - kAround + k, crown - kAround + (k + 1) % kAround, crown});
  part.colors.assign(part.positions.size(), kColor);
  return part;
}

}  // namespace mien::head
