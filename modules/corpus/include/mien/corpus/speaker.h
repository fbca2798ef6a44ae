#pragma once
#include <span>
#include <string>
#include <string_view>

#include "mien/base/random.h"

namespace mien {

/// How a person moves: gains of articulation and habits of the upper face (specification, section 6). The
/// default is the default style: every gain 1, no anticipation, no asymmetry.
struct Speaker {
  std::string id = "default";
  double jaw = 1, lip = 1, round = 1, spread = 1, press = 1;  ///< gains of articulation
  double width = 1;                                           ///< of co-articulation
  double lead_s = 0;                                          ///< anticipation
  double asymmetry = 0;  ///< left side times 1 + a, right side times 1 - a
  double rest_smile = 0;
  double rest_brow = 0;            ///< > 0 raised, < 0 lowered
  double blinks_per_minute = 18;   ///< primary blinks
  double brow_probability = 0.24;  ///< of a raise at an accent
  double brow_amplitude = 0.22;
  double nod_probability = 0.35;  ///< at an accent
  double nod_deg = 2.4;
  double gaze_away = 0.30;  ///< share of looking away
  double gaze_deg = 9;      ///< mean amplitude of looking away
  double head_deg = 1.1;    ///< of the slow head sway
  double squint_talk = 0;   ///< squint while talking
  double emotion_gain = 1;
  bool mirror_contempt = false;  ///< contempt on the left instead of the right
};

inline constexpr int kNumFixedSpeakers = 16;
/// S00 ... S15. S00 ... S11 are the training styles; the odd ones mirror contempt.
std::span<const Speaker, kNumFixedSpeakers> fixed_speakers();
inline constexpr int kNumTrainingStyles = 12;

/// One of fixed_speakers() by id, or null.
const Speaker* find_speaker(std::string_view id);

/// A speaker drawn from the distributions of section 6.
Speaker draw_speaker(Rng& rng);

}  // namespace mien
