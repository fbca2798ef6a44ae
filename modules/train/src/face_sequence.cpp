#include "mien/train/face_sequence.h"

#include "mien/base/contract.h"

namespace mien::train {
namespace {

Error unfit(const FaceSequence& sequence, const std::string& why) {
  return {Errc::incompatible, "sequence '" + sequence.name + "'", why, "Check the data: mien data check"};
}

}  // namespace

std::vector<float> one_hot_weights(std::int64_t index, std::int64_t count) {
  contract(index >= 0 && index < count, "one_hot_weights: there is no such column");
  std::vector<float> weights(static_cast<std::size_t>(count));
  weights[static_cast<std::size_t>(index)] = 1;
  return weights;
}

Result<std::int64_t> num_frames_of(const FaceSequence& sequence, std::int64_t width) {
  const auto num_values = static_cast<std::int64_t>(sequence.motion.size());
  if (num_values == 0 || num_values % width != 0)
    return unfit(sequence, std::to_string(num_values) + " numbers are no frames of " + std::to_string(width));
  return num_values / width;
}

Result<Alignment> align_sequence(const FaceSequence& sequence, std::int64_t width,
                                 const EncoderConfig& encoder, double fps) {
  MIEN_TRY(const std::int64_t num_frames, num_frames_of(sequence, width));
  const auto num_samples = static_cast<std::int64_t>(sequence.waveform.size());
  Alignment alignment = align_features(encoder.num_frames(num_samples), num_frames, fps);
  if (alignment.num_frames < 1) return unfit(sequence, "its sound is too short for a frame");
  return alignment;
}

}  // namespace mien::train
