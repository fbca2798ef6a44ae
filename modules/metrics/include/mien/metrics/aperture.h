#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/core/vector.h"

namespace mien {

/// The rate at which everything is measured: predictions at other rates are interpolated linearly first.
inline constexpr double kMetricFps = 60;

/// How the lip opening A(t) is read off a motion (human benchmark README, "Measurements"). Always printed
/// with a result.
enum class ApertureVariant {
  curves,  ///< jawOpen - mouthClose; nothing clamped
  press,   ///< jawOpen - mouthClose - 0.5 (mouthPressLeft + mouthPressRight): for faces that seal the lips by
           ///< pressing only
  mesh,    ///< distance of the inner lips' mid-points minus its value on the neutral face, millimetres
};
std::string_view aperture_name(ApertureVariant variant);

/// Lip opening over time at 60 frames/s, frame n = the instant n / 60.
struct Aperture {
  ApertureVariant variant = ApertureVariant::curves;
  std::vector<double>
      values;  // [N] coefficient units, or millimetres for mesh; 0 = touching, negative = pressed
};

/// The motion at 60 frames/s, checked: every value finite. Errors (Errc::failed): a NaN or infinity, by frame
/// and channel; (Errc::incompatible): a frame rate that is not positive.
Result<Motion> at_metric_rate(const Motion& motion);

/// Aperture of a motion of ARKit coefficients at 60 frames/s.
/// Errors (Errc::incompatible): no channel jawOpen, mouthClose or (press) mouthPressLeft and Right. @pre
/// variant != mesh, motion.fps == 60
Result<Aperture> curve_aperture(const Motion& motion, ApertureVariant variant);

/// Which vertices are the mid-points of the inner upper and the inner lower lip.
struct LipMidpoints {
  std::int64_t upper = 0, lower = 0;
};
/// Aperture of a motion in space `vertices` (channels x, y, z of every vertex, metres) at 60 frames/s.
/// @param neutral  [V] the face with lips closed, metres
/// Errors (Errc::incompatible): not a vertex motion, or vertex indices outside it.
Result<Aperture> mesh_aperture(const Motion& motion, std::span<const Vec3> neutral, LipMidpoints lips);

/// One channel as a series of doubles. Errors (Errc::incompatible): no such channel.
Result<std::vector<double>> channel_series(const Motion& motion, std::string_view channel);

}  // namespace mien
