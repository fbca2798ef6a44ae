#include "mien/models/said/speech_front.h"

#include <numeric>
#include <string>
#include <vector>

#include "mien/base/contract.h"
#include "mien/tensor/ops.h"

namespace mien::said {
namespace {

constexpr std::int64_t kSampleRateHz = 16000;

std::int64_t frames_of(std::int64_t num_samples, std::int64_t fps) {
  const double seconds = static_cast<double>(num_samples) / static_cast<double>(kSampleRateHz);
  return static_cast<std::int64_t>(seconds * static_cast<double>(fps));
}

}  // namespace

SpeechLength speech_length(std::int64_t num_samples, std::int64_t fps, std::int64_t divisor) {
  contract(num_samples >= 0 && fps >= 1 && fps <= kSampleRateHz && divisor >= 1,
           "speech_length: samples, rate or divisor out of range");
  const std::int64_t quantum = kSampleRateHz / std::gcd(kSampleRateHz, fps) * divisor;
  const std::int64_t padded = (num_samples + quantum - 1) / quantum * quantum;
  return {padded, frames_of(num_samples, fps), frames_of(padded, fps)};
}

Status encode_speech(const EncoderRuntime& encoder, std::span<const float> samples,
                     const EncodeOptions& options, const std::function<void(const Tensor&)>& sink) {
  const SpeechLength length = speech_length(static_cast<std::int64_t>(samples.size()));
  if (length.num_frames == 0)
    return Error{Errc::input, "speech",
                 "is too short: " + std::to_string(samples.size()) +
                     " samples at 16 kHz give no frame at 60 frames a second",
                 "At least 267 samples are needed"};
  std::vector<float> padded(samples.begin(), samples.end());
  padded.resize(static_cast<std::size_t>(length.padded_samples));
  EncodeOptions own = options;
  own.num_frames = length.model_frames;
  return encoder.encode(padded, own, sink);
}

Result<Tensor> encode_speech(const EncoderRuntime& encoder, std::span<const float> samples,
                             const EncodeOptions& options) {
  Tensor all;
  MIEN_TRY([[maybe_unused]] const auto encoded,
           encode_speech(encoder, samples, options, [&](const Tensor& frames) {
             all = all.count() == 0 ? frames : concat_rows(all, frames);
           }));
  return all;
}

}  // namespace mien::said
