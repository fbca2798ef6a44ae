#include "hearing.h"

#include <algorithm>
#include <cmath>

#include "lip_contact.h"
#include "mien/base/contract.h"
#include "mien/core/audio_clip.h"
#include "mien/core/motion.h"
#include "mien/models/default/stream.h"

namespace mien::default_model {
namespace {

constexpr std::int64_t kBatch = 64;  // frames that go through the networks together, at most

// Silence gate, in mel frames around the instant: loudest of -15 ... +10, averaged over -10 ... +7.
constexpr std::int64_t kLoudestBefore = 15, kLoudestAfter = 10, kAverageBefore = 10, kAverageAfter = 7;
constexpr float kGateClosed = -5.5f;  // ln power below the running level (24 dB): silence; 1 above it: speech

}  // namespace

Hearing::Hearing(const DefaultModel& model)
    : model_(model),
      front_(model),
      recent_features_({kGroupFrames - 1, model.metadata().sizes.width}),
      context_({1, kContextGroups * model.metadata().sizes.width}) {}

void Hearing::push(std::span<const float> samples) {
  contract(num_frames_ < 0, "DefaultStream: push after finish");
  num_samples_ += static_cast<std::int64_t>(samples.size());
  front_.push(samples);
}

void Hearing::finish() {
  contract(num_frames_ < 0, "DefaultStream: finish was called before");
  front_.finish();
  num_frames_ =
      num_motion_frames(static_cast<double>(num_samples_) / kModelSampleRateHz, DefaultStream::kFps);
}

bool Hearing::hear(Heard& next) {
  next = {num_heard_, front_.take(kBatch), {}, {}};
  const std::int64_t count = next.features.num_rows();
  if (count == 0) return false;
  const Tensor events = model_.network().encoder.events(next.features);
  for (std::int64_t i = 0; i < count; ++i)
    next.closed_probability.push_back(1 / (1 + std::exp(-events.row(i)[0])));
  const Tensor around = Operations<Tensor>::concat_rows({recent_features_, next.features});
  constexpr auto kReach = kGroupFrames - 1;
  for (std::int64_t i = 0; i < count; ++i) {
    if ((num_heard_ + i) % kGroupFrames != 0) continue;
    add_group(mien::rows(around, i, kGroupFrames));
    next.contexts.push_back(context_);
  }
  recent_features_ = mien::rows(around, around.num_rows() - kReach, kReach);
  num_heard_ += count;
  return true;
}

// Appends the mean of a group of features to the speech context, which forgets its oldest group.
void Hearing::add_group(const Tensor& features) {
  const std::int64_t width = features.width();
  std::copy(context_.data() + width, context_.data() + context_.count(), context_.data());
  float* mean = context_.data() + context_.count() - width;
  std::fill_n(mean, width, 0.0f);
  for (std::int64_t i = 0; i < kGroupFrames; ++i)
    for (std::int64_t c = 0; c < width; ++c)
      mean[c] += features.data()[i * width + c] / static_cast<float>(kGroupFrames);
}

float Hearing::speech_gate(std::int64_t n) const {
  const std::int64_t centre = (5 * n + 1) / 3;
  float sum = 0;
  for (std::int64_t t = centre - kAverageBefore; t <= centre + kAverageAfter; ++t) {
    float loudest = -100;
    for (std::int64_t s = t - kLoudestBefore; s <= std::min(t + kLoudestAfter, centre + kAverageAfter); ++s)
      loudest = std::max(loudest, front_.loudness(s));
    sum += smooth_step(loudest - kGateClosed);
  }
  return sum / static_cast<float>(kAverageBefore + kAverageAfter + 1);
}

void Hearing::forget_before(std::int64_t n) {
  front_.drop_loudness_before(5 * n / 3 - kLoudestBefore - kAverageBefore - 2);
}

}  // namespace mien::default_model
