#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mien/core/arkit.h"
#include "mien/corpus/emotion.h"
#include "mien/corpus/performance.h"
#include "mien/corpus/speaker.h"

namespace mien {

/// Frame rate of all curves of the corpus.
inline constexpr double kCorpusFps = 60;

/// Gains and timing of the mouth in one performance; the default is the default style.
struct ArticulationStyle {
  double jaw = 1, lip = 1, round = 1, spread = 1;  ///< act on the targets, before blending
  double press = 1;
  double width = 1;  ///< of co-articulation: factor on all flanks
  double lead_s = 0;
  double asymmetry = 0;
};
ArticulationStyle articulation_style(const Speaker& speaker, Emotion emotion, double intensity);

/// State of the mouth at one frame: eight blended channels and three overrides (specification, 4.1 and 4.2).
struct ArticulatorFrame {
  std::array<float, kNumArticulators> blended{};  ///< indexed by Articulator
  float closure = 0;                              ///< LC, of the lips
  float labiodental = 0;                          ///< LF, lower lip on the upper teeth
  float pressure = 0;                             ///< PL, behind the lips

  [[nodiscard]] float operator[](Articulator a) const { return blended[static_cast<std::size_t>(a)]; }
};

/// Blends the targets of all phones on a 240 Hz grid with dominance functions (after Cohen & Massaro 1993,
/// with Gaussian flanks), adds the overrides that must be reached, smooths (sigma 12 ms) and keeps the 60 fps
/// frames.
/// @param phones       in time order
/// @param phone_gains  gain on all targets of each phone; empty = 1
/// @return num_frames frames, frame n at n / 60 s
std::vector<ArticulatorFrame> articulate(std::span<const PhoneSegment> phones, const ArticulationStyle& style,
                                         std::int64_t num_frames, std::span<const double> phone_gains = {});

/// ARKit coefficients of the mouth for one frame (specification, 4.3), clamped to 0 ... 1; the others are 0.
ArkitFrame mouth_pose(const ArticulatorFrame& mouth, const ArticulationStyle& style);

}  // namespace mien
