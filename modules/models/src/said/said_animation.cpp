#include <algorithm>
#include <optional>

#include "mien/base/contract.h"
#include "mien/models/said/said_model.h"
#include "mien/models/said/speech_front.h"

namespace mien {
namespace {

constexpr std::uint32_t kSaidNoiseStream = 3;  // 1: the default model, 2: FaceDiffuser

// `known` with its last frame repeated, so that the motion of a clip is as long as its padded speech.
KeptValues extended(const KeptValues& known, std::int64_t num_frames) {
  std::vector<float> values, weights;
  for (std::int64_t n = 0; n < num_frames; ++n)
    for (std::int64_t c = 0; c < known.num_channels(); ++c) {
      const std::int64_t from = std::min(n, known.num_frames() - 1);
      values.push_back(known.value(from, c));
      weights.push_back(known.weight(from, c));
    }
  return {known.num_channels(), std::move(values), std::move(weights)};
}

// The noise of a take from frame `first` on: that of the whole motion.
class LaterNoise final : public FrameNoise {
 public:
  LaterNoise(const FrameNoise& whole, std::int64_t first) : whole_(whole), first_(first) {}
  void start(std::int64_t frame, std::span<float> out) const override { whole_.start(first_ + frame, out); }
  void step(int step, std::int64_t frame, std::span<float> out) const override {
    whole_.step(step, first_ + frame, out);
  }

 private:
  const FrameNoise& whole_;
  std::int64_t first_;
};

// Takes that grow window by window, not yet clamped.
class Performance {
 public:
  Performance(const SaidModel& model, const SaidOptions& options, int num_takes, int num_threads,
              Progress& progress)
      : model_(model),
        process_(model.process()),
        options_(options),
        num_threads_(num_threads),
        num_channels_(model.description().output.channels),
        progress_(progress),
        takes_(static_cast<std::size_t>(num_takes)) {
    for (int take = 0; take < num_takes; ++take)
      noise_.emplace_back(performance_seed(options.seed, take), kSaidNoiseStream, num_channels_);
  }

  /// `num_frames` of all takes at once, from nothing or from known values.
  Status whole(const Tensor& context, std::int64_t num_frames, const KeptValues* known) {
    said::Walk walk{.num_frames = num_frames, .num_channels = num_channels_};
    for (const auto& own : noise_) walk.takes.push_back(&own);
    walk.known = known;
    return run(context, walk, 0, 0);
  }

  /// Frames first ... first + context rows - 1, of which the first `overlap` are there already. Takes go one
  /// after the other, because each has its own past.
  Status window(const Tensor& context, std::int64_t first, std::int64_t overlap) {
    if (overlap == 0) return whole(context, context.num_rows(), nullptr);
    for (std::size_t take = 0; take < takes_.size(); ++take) {
      const LaterNoise noise(noise_[take], first);
      const auto count = static_cast<std::size_t>(context.num_rows() * num_channels_);
      const auto past = static_cast<std::size_t>(overlap * num_channels_);
      std::vector<float> values(count), weights(count);
      std::copy_n(takes_[take].end() - static_cast<std::ptrdiff_t>(past), past, values.begin());
      std::fill_n(weights.begin(), past, 1.0f);
      const KeptValues known(num_channels_, std::move(values), std::move(weights));
      said::Walk walk{.num_frames = context.num_rows(), .num_channels = num_channels_};
      walk.takes = {&noise};
      walk.known = &known;
      walk.starts_from_noise = true;
      MIEN_TRY([[maybe_unused]] const auto done, run(context, walk, take, overlap));
    }
    return Done{};
  }

  [[nodiscard]] const std::vector<std::vector<float>>& takes() const { return takes_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  // Appends the frames from `overlap` on to takes first_take ...
  Status run(const Tensor& context, const said::Walk& walk, std::size_t first_take, std::int64_t overlap) {
    const std::vector<said::FastDenoiser::Speech> speech = {
        model_.denoiser().listen(context, walk.num_frames)};
    auto frames = said::sample(model_.denoiser().network(speech, num_threads_), process_, options_.sampling,
                               walk, progress_);
    if (!frames) return frames.error();
    for (std::size_t l = 0; l < walk.takes.size(); ++l) {
      const auto first = static_cast<std::int64_t>(l) * walk.num_frames + overlap;
      const Tensor own = rows(*frames, first, walk.num_frames - overlap);
      auto& values = takes_[first_take + l];
      values.insert(values.end(), own.values().begin(), own.values().end());
    }
    if (warnings_.empty()) warnings_ = frames.warnings;  // those of every window are the same
    return Done{};
  }

  const SaidModel& model_;
  DiffusionProcess process_;
  const SaidOptions& options_;
  int num_threads_;
  std::int64_t num_channels_;
  Progress& progress_;
  std::vector<SeededFrameNoise> noise_;
  std::vector<std::vector<float>> takes_;  // [N so far, K]
  std::vector<std::string> warnings_;
};

// Speech encoded in windows of `size` frames, with context on both sides, and animated as soon as a window is
// there.
Status animate_in_windows(const SaidModel& model, const AudioClip& clip, const SaidOptions& options,
                          std::int64_t size, const said::SpeechLength& length, int num_threads,
                          Performance& performance) {
  constexpr auto kContext = static_cast<std::int64_t>(kWindowContext_s * kSaidFps);
  EncodeOptions encoding;
  encoding.num_threads = num_threads;
  encoding.windows = {.frames = size - options.overlap, .left = kContext, .right = kContext};
  Tensor waiting;  // context of the frames from `first` on
  std::int64_t first = 0, overlap = 0;
  Status status = Done{};
  const auto run_window = [&](std::int64_t count) {
    if (status) status = performance.window(rows(waiting, 0, count), first, overlap);
    overlap = options.overlap;
    first += count - overlap;
    waiting = rows(waiting, count - overlap, waiting.num_rows() - count + overlap);
  };
  const Status encoded =
      said::encode_speech(model.encoder(), clip.samples, encoding, [&](const Tensor& features) {
        const Tensor context = model.denoiser().context(features);
        waiting = waiting.count() == 0 ? context : concat_rows(waiting, context);
        // The last window takes what would be too little for one of its own.
        while (status && waiting.num_rows() >= size && length.model_frames - first - size >= options.overlap)
          run_window(size);
      });
  if (!encoded) return encoded.error();
  if (!status) return status.error();
  run_window(waiting.num_rows());
  return status;
}

}  // namespace

Result<std::vector<Motion>> animate(const SaidModel& model, const AudioClip& clip, const SaidOptions& options,
                                    int num_takes, int num_threads, Progress& progress) {
  contract(num_takes >= 1, "animate: at least one take is needed");
  const double speech_s = static_cast<double>(clip.samples.size()) / kModelSampleRateHz;
  const bool is_long = !options.window && options.known == nullptr && speech_s > kLongSpeech_s;
  const std::int64_t window =
      is_long ? static_cast<std::int64_t>(kLongSpeechWindow_s * kSaidFps) : options.window.value_or(0);
  contract(window == 0 || (options.overlap >= 1 && window >= 2 * options.overlap),
           "animate: a window must be twice as long as the overlap, or longer");
  contract(window == 0 || options.known == nullptr, "animate: windows exclude known values");
  const said::SpeechLength length = said::speech_length(static_cast<std::int64_t>(clip.samples.size()));
  Performance performance(model, options, num_takes, num_threads, progress);
  progress.stage("encoding", 0);
  std::int64_t num_frames = length.num_frames;
  if (window > 0 && length.model_frames >= window + options.overlap) {
    MIEN_TRY([[maybe_unused]] const auto done,
             animate_in_windows(model, clip, options, window, length, num_threads, performance));
  } else {
    MIEN_TRY(const Tensor context, model.context(clip, num_threads));
    std::optional<KeptValues> known;
    std::int64_t walked = length.model_frames;
    if (options.known != nullptr) {
      contract(options.known->num_channels() == model.description().output.channels &&
                   options.known->num_frames() > 0,
               "animate: known values of another width, or none");
      known = options.known->num_frames() == length.num_frames ? extended(*options.known, length.model_frames)
                                                               : *options.known;
      walked = known->num_frames();
      num_frames = std::min(num_frames, walked);
    }
    MIEN_TRY([[maybe_unused]] const auto done, performance.whole(context, walked, known ? &*known : nullptr));
  }
  std::vector<Motion> takes(static_cast<std::size_t>(num_takes), model.empty_motion());
  for (std::size_t take = 0; take < takes.size(); ++take) {
    auto& values = takes[take].values;
    values = performance.takes()[take];
    values.resize(static_cast<std::size_t>(num_frames * takes[take].num_channels()));
    for (float& v : values) v = std::clamp(v, 0.0f, 1.0f);
  }
  Result<std::vector<Motion>> result(std::move(takes));
  result.warnings = performance.warnings();
  if (is_long) result.warnings.push_back(windows_warning(speech_s));
  return result;
}

}  // namespace mien
