#include "mien/metrics/aperture.h"

#include <cmath>

#include "mien/base/contract.h"

namespace mien {
namespace {

constexpr double kMillimetresPerMetre = 1000;

Vec3 vertex(std::span<const float> frame, std::int64_t index) {
  const auto i = static_cast<std::size_t>(3 * index);
  return {frame[i], frame[i + 1], frame[i + 2]};
}

}  // namespace

std::string_view aperture_name(ApertureVariant variant) {
  switch (variant) {
    case ApertureVariant::curves:
      return "jawOpen - mouthClose";
    case ApertureVariant::press:
      return "jawOpen - mouthClose - 0.5 (mouthPressLeft + mouthPressRight)";
    case ApertureVariant::mesh:
      return "inner lip gap above neutral, mm";
  }
  return "";
}

Result<Motion> at_metric_rate(const Motion& motion) {
  if (!(motion.fps > 0) || !std::isfinite(motion.fps))
    return Error{Errc::incompatible, "motion", "its frame rate is not a positive number", ""};
  for (std::size_t i = 0; i < motion.values.size(); ++i) {
    if (std::isfinite(motion.values[i])) continue;
    const auto width = static_cast<std::size_t>(motion.num_channels());
    return Error{Errc::failed, "motion",
                 "channel '" + motion.channel_name(static_cast<std::int64_t>(i % width)) + "' of frame " + std::to_string(i / width) +
                     " is not a finite number",
                 ""};
  }
  return resample(motion, kMetricFps);
}

Result<std::vector<double>> channel_series(const Motion& motion, std::string_view channel) {
  const auto index = motion.find(channel);
  if (!index) return Error{Errc::incompatible, "motion", "has no channel '" + std::string(channel) + "'", ""};
  std::vector<double> out(static_cast<std::size_t>(motion.num_frames()));
  for (std::size_t n = 0; n < out.size(); ++n)
    out[n] = motion.frame(static_cast<std::int64_t>(n))[static_cast<std::size_t>(*index)];
  return out;
}

Result<Aperture> curve_aperture(const Motion& motion, ApertureVariant variant) {
  contract(variant != ApertureVariant::mesh && motion.fps == kMetricFps,
           "curve_aperture: 60 fps curves expected");
  MIEN_TRY(const std::vector<double> jaw, channel_series(motion, "jawOpen"));
  MIEN_TRY(const std::vector<double> close, channel_series(motion, "mouthClose"));
  Aperture out{variant, jaw};
  for (std::size_t n = 0; n < jaw.size(); ++n) out.values[n] -= close[n];
  if (variant == ApertureVariant::curves) return out;
  MIEN_TRY(const std::vector<double> left, channel_series(motion, "mouthPressLeft"));
  MIEN_TRY(const std::vector<double> right, channel_series(motion, "mouthPressRight"));
  for (std::size_t n = 0; n < jaw.size(); ++n) out.values[n] -= 0.5 * (left[n] + right[n]);
  return out;
}

Result<Aperture> mesh_aperture(const Motion& motion, std::span<const Vec3> neutral, LipMidpoints lips) {
  contract(motion.fps == kMetricFps, "mesh_aperture: 60 fps expected");
  const auto fail = [](const std::string& why) { return Error{Errc::incompatible, "lip gap", why, ""}; };
  const auto num_vertices = static_cast<std::int64_t>(neutral.size());
  if (motion.space != MotionSpace::vertices || motion.num_channels() != 3 * num_vertices)
    return fail("the motion has " + std::to_string(motion.num_channels()) +
                " channels, expected x, y, z of " + std::to_string(num_vertices) + " vertices");
  if (lips.upper < 0 || lips.lower < 0 || lips.upper >= num_vertices || lips.lower >= num_vertices)
    return fail("a lip vertex lies outside the mesh of " + std::to_string(num_vertices) + " vertices");
  const double rest =
      length(neutral[static_cast<std::size_t>(lips.upper)] - neutral[static_cast<std::size_t>(lips.lower)]);
  Aperture out{ApertureVariant::mesh, {}};
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    const auto frame = motion.frame(n);
    const double gap = length(vertex(frame, lips.upper) - vertex(frame, lips.lower));
    out.values.push_back((gap - rest) * kMillimetresPerMetre);
  }
  return out;
}

}  // namespace mien
