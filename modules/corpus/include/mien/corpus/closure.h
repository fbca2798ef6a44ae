#pragma once
#include <optional>

#include "mien/corpus/performance.h"

namespace mien {

/// Where phone times come from; it decides in which part of a bilabial segment the lips really touch.
enum class PhoneSource {
  espeak,       ///< espeak-ng events
  statistical,  ///< flite slt, awb, rms
  hts,          ///< festival cmu_us_slt_arctic_hts
  diphone,      ///< flite kal, kal16; festival kal_diphone, ked_diphone
  festvox_ru,   ///< labels of the festvox-ru recordings
};

/// Lip-closure window of p, b or m (specification, section 1.4); nothing for other phones.
/// @param event_s  espeak only: the instant of the phone's event. A voiceless stop that was repaired starts
/// before it, with the silent run; one that was not starts with it
std::optional<TimeSpan> closure_window(PhoneSource source, const PhoneSegment& segment, double event_s);

}  // namespace mien
