#include "speech_front.h"

#include <algorithm>
#include <array>

namespace mien::default_model {
namespace {

constexpr float kSilence = -14.0f;  // relative log-mel of digital silence, where normalise_mel clips

// Frame n lies at mel position 5 n / 3 + shift: between rows left and left + 1.
struct MelPosition {
  std::int64_t left;
  float weight;
};
MelPosition mel_position(std::int64_t n, std::int64_t shift) {
  return {5 * n / 3 + shift, static_cast<float>(5 * n % 3) / 3.0f};
}

}  // namespace

SpeechFront::SpeechFront(const DefaultModel& model)
    : model_(model), encoded_(Tensor({0, model.metadata().sizes.width})) {}

void SpeechFront::push(std::span<const float> samples) {
  log_mel_.push(samples);
  collect_mel();
}

void SpeechFront::collect_mel() {
  std::array<float, kNumMelBands> frame;
  while (log_mel_.pop(frame)) {
    const float level = level_.push(frame);
    loudness_.push_back(frame_level(frame) - level);
    for (const float band : frame) pending_.push_back(normalise_mel(band, level));
  }
}

void SpeechFront::finish() {
  log_mel_.finish();
  collect_mel();
  finished_ = true;
}

// Encodes what is pending, and silence after it.
void SpeechFront::encode(std::int64_t num_silent) {
  pending_.resize(pending_.size() + static_cast<std::size_t>(num_silent * kMelBands),
                  normalise_mel(kSilence, 0));
  const auto num_rows = static_cast<std::int64_t>(pending_.size()) / kMelBands;
  if (num_rows == 0) return;
  mel_state_.rewind();
  const Tensor rows =
      model_.network().encoder.encode_mel(Tensor({num_rows, kMelBands}, pending_), &mel_state_);
  pending_.clear();
  encoded_ = Operations<Tensor>::concat_rows({encoded_, rows});
}

std::int64_t SpeechFront::num_frames_heard() const {
  const std::int64_t end = encoded_start_ + encoded_.num_rows();
  std::int64_t n = next_frame_;
  while (mel_position(n, model_.metadata().look_ahead_mel_frames).left + 1 < end) ++n;
  return n;
}

Tensor SpeechFront::take(std::int64_t limit) {
  const std::int64_t shift = model_.metadata().look_ahead_mel_frames;
  encode(0);
  std::int64_t end = std::min(num_frames_heard(), next_frame_ + limit);
  if (finished_ && end < next_frame_ + limit) {
    end = next_frame_ + limit;
    encode(std::max<std::int64_t>(
        0, mel_position(end - 1, shift).left + 2 - encoded_start_ - encoded_.num_rows()));
  }
  const std::int64_t count = end - next_frame_, width = encoded_.width();
  if (count <= 0) return Tensor({0, width});
  Tensor at_motion_rate = Tensor::uninitialized({count, width});
  for (std::int64_t i = 0; i < count; ++i) {
    const auto [left, weight] = mel_position(next_frame_ + i, shift);
    const auto a = encoded_.row(left - encoded_start_), b = encoded_.row(left + 1 - encoded_start_);
    const auto out = at_motion_rate.row(i);
    for (std::size_t c = 0; c < out.size(); ++c) out[c] = a[c] + weight * (b[c] - a[c]);
  }
  next_frame_ = end;
  const std::int64_t keep_from = mel_position(next_frame_, shift).left - encoded_start_;
  if (keep_from > 0) {
    const std::int64_t dropped = std::min(keep_from, encoded_.num_rows());
    encoded_ = mien::rows(encoded_, dropped, encoded_.num_rows() - dropped);
    encoded_start_ += dropped;
  }
  frame_state_.rewind();
  return model_.network().encoder.encode_frames(std::move(at_motion_rate), &frame_state_);
}

float SpeechFront::loudness(std::int64_t t) const {
  const std::int64_t at = std::max<std::int64_t>(t, 0) - loudness_start_;
  if (at >= static_cast<std::int64_t>(loudness_.size())) return kSilence;
  return loudness_[static_cast<std::size_t>(std::max<std::int64_t>(at, 0))];
}

void SpeechFront::drop_loudness_before(std::int64_t t) {
  for (; loudness_start_ < t && !loudness_.empty(); ++loudness_start_) loudness_.pop_front();
}

}  // namespace mien::default_model
