#include "mien/datasets/scaling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mien/base/contract.h"

namespace mien {

Result<AxisScale> box_scale(std::span<const float> neutral) {
  contract(neutral.size() % 3 == 0, "box_scale: three numbers per vertex expected");
  const auto bad = [](std::string why) { return Error{Errc::input, "template", std::move(why), ""}; };
  if (neutral.empty()) return bad("has no vertices");
  AxisScale scale;
  const auto count = static_cast<double>(neutral.size() / 3);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low, sum = 0;
    for (std::size_t i = axis; i < neutral.size(); i += 3) {
      const auto x = static_cast<double>(neutral[i]);
      if (!std::isfinite(x)) return bad("vertex " + std::to_string(i / 3) + " is not finite");
      low = std::min(low, x), high = std::max(high, x), sum += x;
    }
    if (!(high > low)) return bad(std::string("has no extent along ") + "xyz"[axis]);
    scale.centre[axis] = sum / count;
    scale.size[axis] = high - low;
  }
  return scale;
}

AxisScale multiface_scale() {
  constexpr std::array<double, 3> kLow = {-117.798, -213.735, -177.091},
                                  kHigh = {125.922, 185.79601, 75.365097};
  AxisScale scale;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    scale.centre[axis] = (kLow[axis] + kHigh[axis]) / 2;
    scale.size[axis] = (kHigh[axis] - kLow[axis]) / 2;
  }
  return scale;
}

void apply_scale(const AxisScale& scale, std::span<float> values) {
  contract(values.size() % 3 == 0, "apply_scale: three numbers per vertex expected");
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] =
        static_cast<float>((static_cast<double>(values[i]) - scale.centre[i % 3]) / scale.size[i % 3]);
}

void undo_scale(const AxisScale& scale, std::span<float> values) {
  contract(values.size() % 3 == 0, "undo_scale: three numbers per vertex expected");
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<float>(static_cast<double>(values[i]) * scale.size[i % 3] + scale.centre[i % 3]);
}

Status scale_by_area(std::span<const std::array<std::uint32_t, 3>> triangles, std::span<float> frame) {
  contract(frame.size() % 3 == 0, "scale_by_area: three numbers per vertex expected");
  const std::size_t num_vertices = frame.size() / 3;
  std::array<double, 3> mean{};
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (i % 3 != 0) frame[i] = -frame[i];
    mean[i % 3] += static_cast<double>(frame[i]) / static_cast<double>(num_vertices);
  }
  double area = 0;
  for (const auto& t : triangles) {
    std::array<double, 3> a{}, b{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto at = [&](std::size_t corner) { return static_cast<double>(frame[3 * t[corner] + axis]); };
      a[axis] = at(1) - at(0), b[axis] = at(2) - at(0);
    }
    area += 0.5 * std::hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
  }
  if (!(area > 0) || !std::isfinite(area)) return Error{Errc::input, "mesh", "its surface has no area", ""};
  const double root = std::sqrt(area);
  for (std::size_t i = 0; i < frame.size(); ++i)
    frame[i] = static_cast<float>((static_cast<double>(frame[i]) - mean[i % 3]) / root);
  return Done{};
}

}  // namespace mien
