#pragma once
#include <cstdint>
#include <limits>

namespace mien {

/// What a figure is where it is not defined, so that a table can say so instead of showing a made-up zero.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// part / whole; NaN of nothing.
inline double ratio(double part, double whole) { return whole > 0 ? part / whole : kNan; }
inline double ratio(std::int64_t part, std::int64_t whole) {
  return ratio(static_cast<double>(part), static_cast<double>(whole));
}

}  // namespace mien
