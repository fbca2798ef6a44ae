#pragma once
#include <string>
#include <vector>

#include "mien/core/features.h"
#include "mien/core/motion.h"
#include "mien/render/image.h"

namespace mien {

/// What a strip of curves shows and where it stands in time.
struct CurveStripOptions {
  double start_seconds = 0;      ///< time at the left border
  double seconds = 4;            ///< time across the strip
  double playhead_seconds = -1;  ///< a vertical line there; negative: none
  /// Curves to draw, 0 at the bottom and 1 at the top; channels that the motion lacks are left out.
  std::vector<std::string> channels{"jawOpen",        "mouthClose",   "mouthPucker",
                                    "mouthSmileLeft", "eyeBlinkLeft", "browInnerUp"};
};

/// A picture of the strip: above, where there are features, their values over time (log-mel: a spectrogram,
/// low bands below), scaled to their range; below it the curves with their names. Without pixels or time it
/// is empty.
///
/// @param log_mel  [T, D] or nullptr; the columns are bands
Image curve_strip(int width, int height, const Motion& motion, const Features* log_mel,
                  const CurveStripOptions& options);

}  // namespace mien
