#pragma once
#include <cstdint>
#include <functional>
#include <span>

#include "mien/models/speech_encoder/encoder_runtime.h"

namespace mien::said {

/// How long a clip is in samples and frames. Its sound is padded with zeros to whole multiples of samples
/// that are whole frames; motion is made for all of it and cut to the frames of the clip itself.
struct SpeechLength {
  std::int64_t padded_samples = 0;  ///< a multiple of 16000 / gcd(16000, fps) * divisor
  std::int64_t num_frames = 0;      ///< of the clip: trunc((S / 16000) fps)
  std::int64_t model_frames = 0;    ///< of the padded clip, the same rule
};
/// In double and in the order of the original (divide, multiply, truncate), which loses a frame where the
/// product falls below a whole number: 32800 samples have 122 frames at 60 fps.
/// @param num_samples  at 16 kHz, not negative;  fps  a whole number of frames a second, 1 ... 16000
/// @param divisor      whole frames come in multiples of this
SpeechLength speech_length(std::int64_t num_samples, std::int64_t fps = 60, std::int64_t divisor = 1);

/// Features of a clip for each of its model_frames: padded, normalised with its padding, encoded with the
/// interpolation to the frame rate in front of the transformer. [model_frames, speech]
/// Errors (Errc::input): fewer samples than a frame has; samples that are not finite.
Result<Tensor> encode_speech(const EncoderRuntime& encoder, std::span<const float> samples,
                             const EncodeOptions& options = {});
/// The same, handing out the frames of each of options.windows as they are ready.
Status encode_speech(const EncoderRuntime& encoder, std::span<const float> samples,
                     const EncodeOptions& options, const std::function<void(const Tensor&)>& sink);

}  // namespace mien::said
