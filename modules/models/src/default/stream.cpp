#include "mien/models/default/stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "blink_events.h"
#include "brow_events.h"
#include "condition.h"
#include "lip_contact.h"
#include "mien/base/contract.h"
#include "mien/core/audio_clip.h"
#include "mien/core/motion.h"
#include "speech_front.h"
#include "upper_face.h"

namespace mien {
namespace {

namespace dm = default_model;

constexpr std::uint32_t kLatentStream = 3;
constexpr std::array<float, 5> kSmoother = {1.0f / 16, 4.0f / 16, 6.0f / 16, 4.0f / 16, 1.0f / 16};
constexpr std::int64_t kBatch = 64;         // frames that go through the networks together, at most
constexpr std::int64_t kClosingFrames = 9;  // of the last frames, over which the mouth shuts

// Silence gate, in mel frames around the instant: loudest of -15 ... +10, averaged over -10 ... +7.
constexpr std::int64_t kLoudestBefore = 15, kLoudestAfter = 10, kAverageBefore = 10, kAverageAfter = 7;
constexpr float kGateClosed = -5.5f;  // ln power below the running level (24 dB): silence; 1 above it: speech

// What the mean path says of a frame.
struct MeanFrame {
  std::array<float, kNumFace> face;  // standardised
  float closed_probability;
};

}  // namespace

struct DefaultStream::State {
  State(const DefaultModel& m, const PerformOptions& o)
      : model(m),
        options(o),
        front(m),
        upper(m, o.seed, o.sampler, o.num_steps),
        blinks(model.network().blink, o.seed),
        brows(model.network().brow, o.seed) {
    contract(o.num_steps >= 1, "PerformOptions: num_steps must be at least 1");
    NoiseField(o.seed, kLatentStream).normal(0, 0, latents);
    for (float& z : latents) z = std::clamp(z * static_cast<float>(o.variety), -2.5f, 2.5f);
    recent_features = Tensor({dm::kGroupFrames - 1, m.metadata().sizes.width});
    context = Tensor({1, dm::kContextGroups * m.metadata().sizes.width});
  }

  // Hears up to kBatch more frames; false when nothing new can be heard.
  bool hear() {
    const Tensor features = front.take(kBatch);
    const std::int64_t count = features.num_rows();
    if (count == 0) return false;
    const auto& network = model.network();
    std::vector<double> seconds;
    for (std::int64_t i = 0; i < count; ++i) seconds.push_back(static_cast<double>(num_heard + i) / kFps);
    const auto input = dm::condition_input(options.direction, seconds, latents);
    mean_state.rewind();
    const Tensor mean = network.mean(features, network.mean.condition(input), &mean_state);
    const Tensor events = network.encoder.events(features);
    for (std::int64_t i = 0; i < count; ++i) {
      MeanFrame frame{};
      std::copy_n(mean.row(i).begin(), kNumFace, frame.face.begin());
      frame.closed_probability = 1 / (1 + std::exp(-events.row(i)[0]));
      means.push_back(frame);
    }
    const Tensor around = Operations<Tensor>::concat_rows({recent_features, features});
    constexpr auto kReach = dm::kGroupFrames - 1;
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t n = num_heard + i;
      if (n % dm::kGroupFrames != 0) continue;
      add_group(mien::rows(around, i, dm::kGroupFrames));
      if (n == 0) upper.start_from(means.front().face);
      decide(n);
    }
    recent_features = mien::rows(around, around.num_rows() - kReach, kReach);
    num_heard += count;
    return true;
  }

  // Appends the mean of a group of features to the speech context, which forgets its oldest group.
  void add_group(const Tensor& features) {
    const std::int64_t width = features.width();
    std::copy(context.data() + width, context.data() + context.count(), context.data());
    float* mean = context.data() + context.count() - width;
    std::fill_n(mean, width, 0.0f);
    for (std::int64_t i = 0; i < dm::kGroupFrames; ++i)
      for (std::int64_t c = 0; c < width; ++c)
        mean[c] += features.data()[i * width + c] / static_cast<float>(dm::kGroupFrames);
  }

  // Lets every path whose step begins when frame n is heard decide it.
  void decide(std::int64_t n) {
    const auto& network = model.network();
    const double seconds = static_cast<double>(n) / kFps;
    const auto input = dm::condition_input(options.direction, {&seconds, 1}, latents);
    if (n % dm::kChunkFrames == 0) {
      upper.add_chunk(context, network.diffusion.condition(input));
      blinks.add_step(context, network.blink.condition(input));
    }
    auto unknown = input;
    unknown.style = Tensor({1, dm::kStyleEntries});
    unknown.style.values().back() = 1;
    brows.add_step(context, network.brow.condition(input), network.brow.condition(unknown));
  }

  [[nodiscard]] const MeanFrame& mean_at(std::int64_t n) const {
    return means[static_cast<std::size_t>(std::max<std::int64_t>(n, 0) - means_start)];
  }

  // Share of speech around a frame: 0 in silence.
  [[nodiscard]] float speech_gate(std::int64_t n) const {
    const std::int64_t centre = (5 * n + 1) / 3;
    float sum = 0;
    for (std::int64_t t = centre - kAverageBefore; t <= centre + kAverageAfter; ++t) {
      float loudest = -100;
      for (std::int64_t s = t - kLoudestBefore; s <= std::min(t + kLoudestAfter, centre + kAverageAfter); ++s)
        loudest = std::max(loudest, front.loudness(s));
      sum += dm::smooth_step(loudest - kGateClosed);
    }
    return sum / static_cast<float>(kAverageBefore + kAverageAfter + 1);
  }

  void compose(std::span<float> channels) {
    const auto& statistics = model.network().statistics;
    std::array<float, kNumFace> face{};
    dm::LipEvidence evidence;
    for (std::int64_t k = -dm::kSmootherReach; k <= dm::kSmootherReach; ++k) {
      const MeanFrame& m = mean_at(next + k);
      const float w = kSmoother[static_cast<std::size_t>(k + dm::kSmootherReach)];
      for (std::size_t i = 0; i < kNumLower; ++i) face[i] += w * m.face[i];
      evidence.closed_probability += w * m.closed_probability;
    }
    upper.frame(next, std::span(face).subspan(kNumLower));
    for (std::size_t i = 0; i < face.size(); ++i)
      face[i] = face[i] * statistics.face_sd.values()[i] + statistics.face_mean.values()[i];
    evidence.speech = speech_gate(next);
    evidence.expression = options.direction.strength(static_cast<double>(next) / kFps);
    if (num_frames >= 0)
      evidence.remaining =
          dm::smooth_step(static_cast<float>(num_frames - 1 - next) / static_cast<float>(kClosingFrames));
    dm::correct_lips(evidence, face);
    decode_face(face, channels);
    apply_brow_raise(channels, brows.height(next));
    apply_blink(channels, blinks.closure(next));
  }

  const DefaultModel model;
  PerformOptions options;
  dm::SpeechFront front;
  dm::UpperFace upper;
  dm::BlinkEvents blinks;
  dm::BrowEvents brows;
  std::array<float, dm::kNumLatents> latents{};
  CausalState<Tensor> mean_state;
  Tensor recent_features;       // the last 3 frames
  Tensor context;               // [1, 3 W] the last groups' means
  std::deque<MeanFrame> means;  // from frame means_start on
  std::int64_t means_start = 0;
  std::int64_t num_heard = 0;  // frames that went through the networks
  std::int64_t next = 0;       // frame to come out
  std::int64_t num_samples = 0;
  std::int64_t num_frames = -1;  // in all, known after finish()
};

DefaultStream::DefaultStream(const DefaultModel& model, const PerformOptions& options)
    : state_(std::make_unique<State>(model, options)) {}
DefaultStream::DefaultStream(DefaultStream&&) noexcept = default;
DefaultStream& DefaultStream::operator=(DefaultStream&&) noexcept = default;
DefaultStream::~DefaultStream() = default;

void DefaultStream::push(std::span<const float> samples) {
  contract(state_->num_frames < 0, "DefaultStream: push after finish");
  state_->num_samples += static_cast<std::int64_t>(samples.size());
  state_->front.push(samples);
}

void DefaultStream::finish() {
  contract(state_->num_frames < 0, "DefaultStream: finish was called before");
  state_->front.finish();
  state_->num_frames = num_motion_frames(static_cast<double>(state_->num_samples) / kModelSampleRateHz, kFps);
}

bool DefaultStream::pop(std::span<float, kNumChannels> frame) {
  State& s = *state_;
  if (s.num_frames >= 0 && s.next >= s.num_frames) return false;
  while (s.num_heard <= s.next + dm::kSmootherReach)
    if (!s.hear()) return false;
  s.compose(frame);
  ++s.next;
  for (; s.means_start < s.next - dm::kSmootherReach; ++s.means_start) s.means.pop_front();
  s.front.drop_loudness_before(5 * s.next / 3 - kLoudestBefore - kAverageBefore - 2);
  return true;
}

}  // namespace mien
