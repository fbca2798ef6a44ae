#include "upper_face.h"

#include <algorithm>

#include "mien/base/contract.h"

namespace mien::default_model {
namespace {

constexpr std::uint32_t kNoiseStream = 1;
constexpr double kGridPower = 1.7;  // dense at the noisy end (docs/default_model.md, section 5)
constexpr std::int64_t kNumbers = kChunkSamples * kNumUpper;

// Cubic interpolation half way between samples 0 and 1, from the four samples given by their index. Inside a
// chunk the stencil is centred; before the last sample of a chunk it leans backwards, so that no frame waits
// for the next chunk.
struct Stencil {
  std::int64_t first;
  std::array<float, 4> weights;
};
constexpr Stencil kCentred = {-1, {-0.0625f, 0.5625f, 0.5625f, -0.0625f}};
constexpr Stencil kBackward = {-2, {0.0625f, -0.3125f, 0.9375f, 0.3125f}};

}  // namespace

UpperFace::UpperFace(const DefaultModel& model, std::uint64_t seed, const SamplerOptions& sampler,
                     int num_steps)
    : model_(model),
      noise_(seed, kNoiseStream),
      sampler_(sampler),
      levels_(cosine_grid(num_steps, kGridPower)),
      state_{Tensor({1, model.metadata().sizes.diffusion_hidden}),
             Tensor({1, model.metadata().sizes.diffusion_hidden})} {
  for (int i = 0; i < num_steps; ++i)
    times_.push_back(
        Tensor({1, kNumTimeFeatures}, time_features(levels_[static_cast<std::size_t>(i)].half_log_snr())));
}

void UpperFace::start_from(std::span<const float> face, const KeptFace* kept) {
  contract(face.size() == kNumFace, "UpperFace::start_from: 45 numbers expected");
  past_ = Tensor({1, kNumbers});
  const KeptFace::Chunk first = kept != nullptr ? kept->chunk(0) : KeptFace::Chunk{};
  for (std::int64_t i = 0; i < kNumbers; ++i) {
    const auto u = static_cast<std::size_t>(i % kNumUpper);
    past_.data()[i] = !first.is_free && first.is_known[u] ? first.samples[u] : face[kNumLower + u];
  }
}

// The known samples in place of those that the coefficients of a chunk decode to. `last` is the sample before
// it.
void UpperFace::know(const KeptFace::Chunk& known, std::span<const float> last,
                     std::span<float> coefficients) const {
  const auto sd = model_.network().statistics.coefficient_sd.values();
  std::vector<float> samples(coefficients.size());
  for (std::size_t i = 0; i < sd.size(); ++i) coefficients[i] *= sd[i];
  decode_chunk(coefficients, last, samples);
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (known.is_known[i]) samples[i] = known.samples[i];
  encode_chunk(samples, last, coefficients);
  for (std::size_t i = 0; i < sd.size(); ++i) coefficients[i] /= sd[i];
}

Tensor UpperFace::sample(const Tensor& h, const Tensor& past, const KeptFace::Chunk& known) const {
  const auto& path = model_.network().diffusion;
  const auto last = past.values().subspan(static_cast<std::size_t>(kNumbers - kNumUpper));
  const auto first_number = static_cast<std::uint64_t>(num_chunks_ * kNumbers);
  const auto last_step = static_cast<int>(times_.size()) - 1;
  Tensor x({1, kNumbers});
  noise_.normal(first_number, 0, x.values());
  const Denoiser denoise = [&](int step, NoiseLevel, std::span<const float> x_t, std::span<float> x0) {
    const Tensor estimate =
        path.predict_x0(h, Tensor({1, kNumbers}, x_t), times_[static_cast<std::size_t>(step)]);
    std::copy(estimate.values().begin(), estimate.values().end(), x0.begin());
    if (!known.is_free && step != last_step) know(known, last, x0);
  };
  const StepNoise fresh = [&](int step, std::span<float> out) {
    noise_.normal(first_number, static_cast<std::uint32_t>(step) + 1, out);
  };
  sample_diffusion(sampler_, levels_, denoise, fresh, x.values());

  const auto sd = model_.network().statistics.coefficient_sd.values();
  for (std::size_t i = 0; i < sd.size(); ++i) x.values()[i] *= sd[i];
  Tensor chunk({1, kNumbers});
  decode_chunk(x.values(), last, chunk.values());
  for (float& v : chunk.values()) v = std::clamp(v, -kLargestStandardised, kLargestStandardised);
  return chunk;
}

void UpperFace::add_chunk(const Tensor& speech, const Tensor& c, const KeptFace* kept) {
  const auto& path = model_.network().diffusion;
  const KeptFace::Chunk known = kept != nullptr ? kept->chunk(num_chunks_) : KeptFace::Chunk{};
  const auto before = state_;
  const Tensor h = path.read(past_, speech, c, state_);
  Tensor chunk({1, kNumbers});
  if (!known.is_known_entirely) {
    chunk = sample(h, past_, known);
  } else if (goes_on_) {
    // Kept frames follow on what was made: how it would have gone on tells how far it missed them.
    auto shadow = before;
    chunk = sample(path.read(made_, speech, c, shadow), made_, {});
  } else {
    std::copy(known.samples.begin(), known.samples.end(), chunk.values().begin());
  }
  goes_on_ = !known.is_known_entirely;
  past_ = made_ = chunk;
  for (std::size_t i = 0; i < known.is_known.size(); ++i)
    if (known.is_known[i]) past_.values()[i] = known.samples[i];
  for (std::int64_t i = 0; i < kChunkSamples; ++i) {
    Sample sample;
    std::copy_n(chunk.data() + i * kNumUpper, kNumUpper, sample.begin());
    samples_.push_back(sample);
  }
  ++num_chunks_;
}

const UpperFace::Sample& UpperFace::sample_at(std::int64_t index) const {
  return samples_[static_cast<std::size_t>(std::max<std::int64_t>(index, 0) - samples_start_)];
}

void UpperFace::frame(std::int64_t n, std::span<float> out) {
  constexpr std::int64_t kStep = kChunkFrames / kChunkSamples;
  const std::int64_t index = n / kStep;
  if (n % kStep == 0) {
    const Sample& sample = sample_at(index);
    std::copy(sample.begin(), sample.end(), out.begin());
  } else {
    const Stencil& stencil = index % kChunkSamples == kChunkSamples - 2 ? kBackward : kCentred;
    std::fill(out.begin(), out.end(), 0.0f);
    for (std::int64_t k = 0; k < 4; ++k) {
      const Sample& sample = sample_at(index + stencil.first + k);
      for (std::size_t u = 0; u < out.size(); ++u)
        out[u] += stencil.weights[static_cast<std::size_t>(k)] * sample[u];
    }
  }
  for (; samples_start_ < index - 2; ++samples_start_) samples_.pop_front();
}

}  // namespace mien::default_model
