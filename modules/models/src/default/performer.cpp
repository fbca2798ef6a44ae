#include "performer.h"

#include <algorithm>
#include <cmath>

#include "condition.h"
#include "lip_contact.h"
#include "mien/base/contract.h"

namespace mien::default_model {
namespace {

constexpr std::uint32_t kLatentStream = 3;
constexpr std::array<float, 5> kSmoother = {1.0f / 16, 4.0f / 16, 6.0f / 16, 4.0f / 16, 1.0f / 16};
constexpr std::int64_t kClosingFrames = 9;  // of the last frames, over which the mouth shuts

}  // namespace

Performer::Performer(const DefaultModel& model, const PerformOptions& options)
    : model_(model),
      options_(options),
      upper_(model, options.seed, options.sampler, options.num_steps),
      blinks_(model_.network().blink, options.seed),
      brows_(model_.network().brow, options.seed) {
  if (options.kept) kept_ = std::make_unique<KeptFace>(*options.kept, model_.network().statistics);
  contract(options.num_steps >= 1, "PerformOptions: num_steps must be at least 1");
  NoiseField(options.seed, kLatentStream).normal(0, 0, latents_);
  for (float& z : latents_) z = std::clamp(z * static_cast<float>(options.variety), -2.5f, 2.5f);
}

void Performer::hear(const Heard& heard) {
  contract(heard.first == num_heard_, "Performer: frames are missing");
  const auto& network = model_.network();
  const std::int64_t count = heard.features.num_rows();
  std::vector<double> seconds;
  for (std::int64_t i = 0; i < count; ++i)
    seconds.push_back(static_cast<double>(num_heard_ + i) / DefaultStream::kFps);
  const auto input = condition_input(options_.direction, seconds, latents_);
  mean_state_.rewind();
  const Tensor mean = network.mean(heard.features, network.mean.condition(input), &mean_state_);
  for (std::int64_t i = 0; i < count; ++i) {
    MeanFrame frame{};
    std::copy_n(mean.row(i).begin(), kNumFace, frame.face.begin());
    frame.closed_probability = heard.closed_probability[static_cast<std::size_t>(i)];
    means_.push_back(frame);
  }
  auto context = heard.contexts.begin();
  for (std::int64_t n = num_heard_; n < num_heard_ + count; ++n) {
    if (n % kGroupFrames != 0) continue;
    if (n == 0) upper_.start_from(means_.front().face, kept_.get());
    decide(n, *context++);
  }
  num_heard_ += count;
}

// Lets every path whose step begins when frame n is heard decide it.
void Performer::decide(std::int64_t n, const Tensor& context) {
  const auto& network = model_.network();
  const double seconds = static_cast<double>(n) / DefaultStream::kFps;
  const auto input = condition_input(options_.direction, {&seconds, 1}, latents_);
  if (n % kChunkFrames == 0) {
    upper_.add_chunk(context, network.diffusion.condition(input), kept_.get());
    blinks_.add_step(context, network.blink.condition(input), kept_.get());
  }
  auto unknown = input;
  unknown.style = Tensor({1, kStyleEntries});
  unknown.style.values().back() = 1;
  brows_.add_step(context, network.brow.condition(input), network.brow.condition(unknown), kept_.get());
}

const Performer::MeanFrame& Performer::mean_at(std::int64_t n) const {
  return means_[static_cast<std::size_t>(std::max<std::int64_t>(n, 0) - means_start_)];
}

void Performer::compose(const Hearing& hearing, std::span<float> channels) {
  contract(is_ready(), "Performer: more must be heard first");
  const auto& statistics = model_.network().statistics;
  std::array<float, kNumFace> face{};
  LipEvidence evidence;
  for (std::int64_t k = -kSmootherReach; k <= kSmootherReach; ++k) {
    const MeanFrame& m = mean_at(next_ + k);
    const float w = kSmoother[static_cast<std::size_t>(k + kSmootherReach)];
    for (std::size_t i = 0; i < kNumLower; ++i) face[i] += w * m.face[i];
    evidence.closed_probability += w * m.closed_probability;
  }
  upper_.frame(next_, std::span(face).subspan(kNumLower));
  for (std::size_t i = 0; i < face.size(); ++i)
    face[i] = face[i] * statistics.face_sd.values()[i] + statistics.face_mean.values()[i];
  evidence.speech = hearing.speech_gate(next_);
  evidence.expression = options_.direction.strength(static_cast<double>(next_) / DefaultStream::kFps);
  if (hearing.num_frames() >= 0)
    evidence.remaining = smooth_step(static_cast<float>(hearing.num_frames() - 1 - next_) /
                                     static_cast<float>(kClosingFrames));
  correct_lips(evidence, face);
  decode_face(face, channels);
  apply_brow_raise(channels, brows_.height(next_));
  const LidClosure closure = blinks_.closure(next_);
  apply_blink(channels, kept_ ? kept_->closure(next_, closure) : closure);
  ++next_;
  for (; means_start_ < next_ - kSmootherReach; ++means_start_) means_.pop_front();
}

}  // namespace mien::default_model
