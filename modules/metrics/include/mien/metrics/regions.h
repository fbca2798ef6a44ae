#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "mien/core/motion.h"

namespace mien {

/// Parts of the face that are measured apart (corpus specification, section 13). Cheeks and nose belong to
/// none.
enum class FaceRegion {
  lower,  ///< jaw, mouth, tongue: 28 curves
  upper,  ///< brows, blink, squint, wide: 11 curves
  gaze,   ///< the eight eyeLook curves
  head,   ///< yaw, pitch, roll in degrees
};
inline constexpr FaceRegion kFaceRegions[] = {FaceRegion::lower, FaceRegion::upper, FaceRegion::gaze,
                                              FaceRegion::head};
inline constexpr std::size_t kNumFaceRegions = 4;
std::string_view region_name(FaceRegion region);

/// Indices into arkit_and_head_channels().
std::span<const std::size_t> region_channels(FaceRegion region);

/// Throws unless the motion is what the corpus and the default model make: the 55 channels of
/// arkit_and_head_channels() at 60 frames/s.
void require_performance(const Motion& motion);

/// Frame-wise mean of motions of equal shape. @pre at least one motion, all with the same channels and frames
Motion mean_motion(std::span<const Motion> motions);

/// One channel of a performance as doubles. @param channel  index into arkit_and_head_channels()
std::vector<double> channel_values(const Motion& motion, std::size_t channel);

}  // namespace mien
