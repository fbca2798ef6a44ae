#pragma once
#include <cstdint>
#include <span>

#include "mien/metrics/aperture.h"
#include "mien/metrics/speech_labels.h"

namespace mien {

/// Predictors without a model, for the reference table at the end of the human benchmark README: they check
/// an implementation of the measures and put its numbers in proportion. `e` is loudness() of the recording,
/// one value a frame.

/// A = 0.12 + 0.4 E, and 0 from 17 ms before to 17 ms after every target closure of the labels, `delay_s`
/// later.
Aperture oracle_aperture(std::span<const double> e, const SpeechLabels& labels, double delay_s);
/// A = 0.5 E.
Aperture loudness_aperture(std::span<const double> e);
/// A = 0.5 clamp(1.6 E - 0.6, 0, 1). The row to quote beside every result.
Aperture steep_loudness_aperture(std::span<const double> e);
/// oracle_aperture() with the same closures at uniformly random times.
Aperture random_aperture(std::span<const double> e, const SpeechLabels& labels, std::uint64_t seed);
/// A = 0.
Aperture shut_aperture(std::size_t num_frames);

}  // namespace mien
