#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mien/core/features.h"

namespace mien {

inline constexpr int kNumMelBands = 64;
inline constexpr int kMelFrameRateHz = 100;
inline constexpr int kMelHop = 160;     ///< samples between frames (10 ms)
inline constexpr int kMelWindow = 400;  ///< samples a frame hears (25 ms), centred on its instant

/// Number of frames of a recording of `num_samples`: one at every 10 ms, both ends included.
constexpr std::int64_t num_mel_frames(std::int64_t num_samples) { return num_samples / kMelHop + 1; }

/// Log energies of 64 mel bands, 100 frames a second: what every model of Mien hears. Frame t is centred on
/// sample 160 t and sees samples 160 t - 200 ... 160 t + 199, zeros beyond both ends. Per frame: periodic
/// Hann window, power spectrum of a 512-point FFT, triangles with centres equally spaced on the scale 2595
/// log10(1 + f/700) between 60 and 7600 Hz and weights of unit sum, ln(energy + 1e-7). Corpus specification,
/// section 14.
///
/// @param samples_16k  [S] mono at 16 kHz, finite; S may be 0 (one frame of silence)
/// @return             [S / 160 + 1, 64] at 100 Hz, not level-normalised (see running_level.h)
Features log_mel(std::span<const float> samples_16k);

/// The same frames, bit for bit, from sound that arrives in pieces of any size. Frame t can be popped as soon
/// as sample 160 t + 199 was pushed: a delay of 12.5 ms after the instant it describes. Samples are kept
/// until the frames they belong to are popped, so memory stays constant when the caller pops after every
/// push.
class LogMelStream {
 public:
  LogMelStream();

  /// @param samples_16k  the next samples, finite   @pre finish() was not called
  void push(std::span<const float> samples_16k);
  /// The sound is over: the frames that reach beyond its end become available.
  void finish();
  /// Writes the next frame and returns true, or returns false when more sound is needed (or all frames were
  /// given).
  bool pop(std::span<float, kNumMelBands> frame);
  /// Frames given so far, which is also the index of the next frame.
  [[nodiscard]] std::int64_t num_popped() const { return num_popped_; }

 private:
  std::vector<float> pending_;  // samples from the start of the next frame's window on
  std::size_t first_ = 0;       // index in pending_ of that start
  std::int64_t num_pushed_ = 0;
  std::int64_t num_popped_ = 0;
  bool finished_ = false;
};

}  // namespace mien
