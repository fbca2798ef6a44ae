#pragma once
#include <span>
#include <vector>

namespace mien {

/// Where sounds begin, in seconds: the audio beats of beat consistency. The method and all constants are
/// those that librosa documents for onset_detect() with hop 512 at 16 kHz (power spectra of 2048 samples, 128
/// mel bands of Slaney's scale up to 8 kHz, decibels within 80 of the largest, mean rise from frame to frame,
/// normalised to 0 ... 1; frames that exceed the mean of the 3 before and the 3 after, themselves included,
/// by 0.07). Written from that documentation; no recorded onsets of librosa were compared.
/// @param samples_16k  [S] mono, 16 kHz. Silence and clips without a rise have no onsets.
std::vector<double> speech_onsets(std::span<const float> samples_16k);

}  // namespace mien
