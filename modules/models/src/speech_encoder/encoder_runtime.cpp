#include "mien/models/speech_encoder/encoder_runtime.h"

#include <algorithm>
#include <cmath>

#include "fast_convolutions.h"
#include "fast_layers.h"
#include "mien/base/contract.h"
#include "mien/base/number_text.h"
#include "mien/models/runtime_parameters.h"

namespace mien {

EncoderWindows windows_of(double seconds) {
  constexpr double kFramesPerSecond = 50;
  const auto frames = [](double s) {
    return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::llround(s * kFramesPerSecond)));
  };
  return {.frames = frames(seconds), .left = frames(kWindowContext_s), .right = frames(kWindowContext_s)};
}

std::string windows_warning(double speech_s) {
  return "speech of " + fixed(speech_s, 0) + " s is taken in windows of " + fixed(kLongSpeechWindow_s, 0) +
         " s, which is not exact; --window chooses them, --window 0 takes all at once";
}

Backend backend_of(EncoderPrecision precision) {
  switch (precision) {
    case EncoderPrecision::bfloat16:
      return Backend::onednn_bf16;
    case EncoderPrecision::int8:
      return Backend::onednn_int8;
    case EncoderPrecision::float32:
      break;
  }
  return Backend::rowwise;
}

namespace {

// Who computes the products of the convolutions and of the projection.
Backend front_backend_of(EncoderPrecision precision) {
  if (precision != EncoderPrecision::int8) return backend_of(precision);
  return backend_available(Backend::onednn_bf16) ? Backend::onednn_bf16 : Backend::rowwise;
}

constexpr std::size_t kReadSamples = 1 << 14;  // at a time, 1 s

// The part of the speech that a window needs, normalised. Parts begin in rising order.
class SlidingSamples {
 public:
  SlidingSamples(SampleSource& speech, WaveformScale scale) : speech_(speech), scale_(scale) {}

  // Samples first ... first + count - 1; valid until the next call.
  Result<std::span<const float>> slide(std::int64_t first, std::int64_t count) {
    while (first_ + static_cast<std::int64_t>(samples_.size()) < first + count) {
      drop_before(first);
      const std::size_t held = samples_.size();
      const auto missing = static_cast<std::size_t>(first + count - first_) - held;
      samples_.resize(held + std::min(missing, kReadSamples));
      const std::span<float> block = std::span(samples_).subspan(held);
      MIEN_TRY(const std::size_t num_read, speech_.read(block));
      if (num_read < block.size())
        return Error{Errc::input, "speech", "became shorter while it was read", "Try again"};
      for (float& x : block) x = scale_(x);
    }
    drop_before(first);
    return std::span<const float>(samples_).first(static_cast<std::size_t>(count));
  }

 private:
  void drop_before(std::int64_t first) {
    const std::int64_t count =
        std::clamp<std::int64_t>(first - first_, 0, static_cast<std::int64_t>(samples_.size()));
    samples_.erase(samples_.begin(), samples_.begin() + count);
    first_ += count;
  }

  SampleSource& speech_;
  WaveformScale scale_;
  std::vector<float> samples_;
  std::int64_t first_ = 0;  // of samples_
};

}  // namespace

bool encoder_precision_available(EncoderPrecision precision) {
  return backend_available(backend_of(precision));
}

struct EncoderRuntime::State {
  State(SpeechEncoder<PlainWeights> weights, EncoderPrecision precision)
      : config(weights.config),
        convolutions(config, weights.conv_layers, front_backend_of(precision)),
        layers(weights, front_backend_of(precision), backend_of(precision)) {}

  EncoderConfig config;
  speech_encoder::FastConvolutions convolutions;
  speech_encoder::FastLayers layers;
};

EncoderRuntime::EncoderRuntime(SpeechEncoder<PlainWeights> weights, EncoderPrecision precision) {
  contract(encoder_precision_available(precision), "EncoderRuntime: this processor cannot run the precision");
  state_ = std::make_shared<const State>(std::move(weights), precision);
}

Result<EncoderRuntime> EncoderRuntime::load(const SafetensorsFile& file, const EncoderConfig& config,
                                            const std::string& prefix, EncoderPrecision precision) {
  if (!encoder_precision_available(precision))
    return Error{Errc::incompatible, "encoder", "this build or processor cannot run the precision asked for",
                 "Use float32"};
  MIEN_TRY([[maybe_unused]] const auto valid, config.validate());
  SpeechEncoder<PlainWeights> weights(config);
  LoadRuntime load(file, prefix);
  weights.visit(load);
  MIEN_TRY([[maybe_unused]] const auto loaded, load.finish());
  return EncoderRuntime(std::move(weights), precision);
}

const EncoderConfig& EncoderRuntime::config() const { return state_->config; }

Result<Tensor> EncoderRuntime::encode(std::span<const float> samples, const EncodeOptions& options) const {
  const std::int64_t width = state_->config.hidden_size;
  std::vector<Tensor> parts;
  MIEN_TRY([[maybe_unused]] const auto encoded,
           encode(samples, options, [&](const Tensor& frames) { parts.push_back(frames); }));
  if (parts.size() == 1) return std::move(parts[0]);
  std::int64_t num_rows = 0;
  for (const Tensor& part : parts) num_rows += part.num_rows();
  Tensor all = Tensor::uninitialized({num_rows, width});
  float* to = all.data();
  for (const Tensor& part : parts) to = std::ranges::copy(part.values(), to).out;
  return all;
}

Status EncoderRuntime::encode(std::span<const float> samples, const EncodeOptions& options,
                              const std::function<void(const Tensor&)>& sink) const {
  SamplesInMemory speech(samples);
  MIEN_TRY(const SpeechStatistics heard, hear(speech));
  return encode(speech, heard, options, sink);
}

Result<SpeechStatistics> EncoderRuntime::hear(SampleSource& speech) const {
  const EncoderConfig& config = state_->config;
  SpeechStatistics heard{.patches = PatchSums(config.conv_kernel[0], config.conv_stride[0])};
  MIEN_TRY([[maybe_unused]] const auto start, speech.rewind());
  std::vector<float> block(kReadSamples);
  for (;;) {
    MIEN_TRY(const std::size_t count, speech.read(block));
    heard.add(std::span(block).first(count));
    if (count < block.size()) break;
  }
  const std::int64_t num_samples = heard.samples.num_samples();
  if (config.num_frames(num_samples) == 0)
    return Error{Errc::input, "speech",
                 "has " + std::to_string(num_samples) + " samples, the encoder needs at least " +
                     std::to_string(config.receptive_field()) + " at 16 kHz",
                 "Use a longer recording"};
  if (!std::isfinite(heard.samples.statistics().covariance[0]))
    return Error{Errc::input, "speech", "holds samples that are not finite numbers", ""};
  return heard;
}

Status EncoderRuntime::encode(SampleSource& speech, const SpeechStatistics& heard,
                              const EncodeOptions& options,
                              const std::function<void(const Tensor&)>& sink) const {
  const EncoderConfig& config = state_->config;
  const EncoderWindows& windows = options.windows;
  contract(windows.frames >= 0 && windows.left >= 0 && windows.right >= 0 && options.num_frames >= 0,
           "EncoderRuntime: windows and frames must not be negative");
  const std::int64_t length = config.num_frames(heard.samples.num_samples());
  contract(length > 0, "EncoderRuntime: hear() accepted no such speech");
  const WaveformScale scale =
      config.do_normalize ? heard.normalisation(config.normalise_eps) : WaveformScale();
  const auto first_layer = state_->convolutions.fold(heard.scaled_patches(scale));
  MIEN_TRY([[maybe_unused]] const auto start, speech.rewind());
  SlidingSamples samples(speech, scale);

  const bool interpolated = options.num_frames > 0;
  const std::int64_t total = interpolated ? options.num_frames : length;
  const auto positions =
      interpolated ? SpeechEncoder<Tensor>::aligned_positions(length, total) : std::vector<double>();
  const std::int64_t kept = windows.frames == 0 ? total : windows.frames;
  for (std::int64_t begin = 0; begin < total; begin += kept) {
    const std::int64_t end = std::min(begin + kept, total);
    const bool whole = windows.frames == 0;
    const std::int64_t first = whole ? 0 : std::max<std::int64_t>(0, begin - windows.left);
    const std::int64_t last = whole ? total : std::min(end + windows.right, total);
    // The frames of the convolutions that frames first ... last - 1 are made from.
    std::int64_t source = first, source_end = last;
    std::vector<double> local;
    if (interpolated) {
      local.assign(positions.begin() + first, positions.begin() + last);
      source = static_cast<std::int64_t>(local.front());
      source_end = std::min(static_cast<std::int64_t>(local.back()) + 2, length);
      for (double& p : local) p -= static_cast<double>(source);
    }
    const std::int64_t count = source_end - source;
    MIEN_TRY(const std::span<const float> heard_now,
             samples.slide(source * config.hop(), (count - 1) * config.hop() + config.receptive_field()));
    Tensor x = Tensor::uninitialized({count, config.conv_dim.back()});
    state_->convolutions.run(heard_now, first_layer, 0, count, x.data(), options.num_threads);
    if (interpolated) x = interpolate_rows(x, local);
    Tensor h = state_->layers.run(std::move(x), options.num_threads, whole ? options.on_hidden : nullptr);
    sink(whole ? std::move(h) : rows(h, begin - first, end - begin));
  }
  return Done{};
}

}  // namespace mien
