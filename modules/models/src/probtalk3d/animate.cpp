#include "animate.h"

#include <algorithm>

#include "face_parts.h"
#include "mien/base/parallel.h"
#include "mien/models/probtalk3d/conventions.h"
#include "mien/models/probtalk3d/takes.h"
#include "style_choice.h"

namespace mien::probtalk3d {
namespace {

// All samples, since their range scales every one of them. Errors: speech that is longer than the positions.
Result<std::vector<float>> whole(SampleSource& speech, const EncoderConfig& encoder) {
  constexpr std::size_t kBlock = 1 << 16;
  MIEN_TRY([[maybe_unused]] const auto begun, speech.rewind());
  std::vector<float> samples;
  for (std::size_t count = kBlock; count == kBlock;) {
    const std::size_t before = samples.size();
    samples.resize(before + kBlock);
    MIEN_TRY(count, speech.read(std::span(samples).subspan(before)));
    samples.resize(before + count);
    const std::int64_t num_frames = encoder.num_frames(static_cast<std::int64_t>(samples.size())) / 2;
    if (num_frames > kMostFrames)
      return Error{Errc::input, "speech",
                   "is too long: the model has positions for " + std::to_string(kMostFrames) +
                       " frames, which are " +
                       std::to_string(before / static_cast<std::size_t>(kModelSampleRateHz)) + " s",
                   "Cut it into pieces at pauses"};
  }
  return samples;
}

// Features of the whole clip in pairs, [N, 2 H]; an odd last one is dropped. Warnings: long speech.
Result<Tensor> hear(const FaceModel::Parts& model, std::vector<float> samples, const FaceOptions& options,
                    int num_threads) {
  stretch_waveform(samples);
  const double speech_s = static_cast<double>(samples.size()) / kModelSampleRateHz;
  const bool is_long = !options.windows && speech_s > kLongSpeech_s;
  std::vector<Tensor> windows;
  const EncodeOptions encoding{
      .num_threads = num_threads,
      .num_frames = 0,
      .windows = is_long ? windows_of(kLongSpeechWindow_s) : options.windows.value_or(EncoderWindows()),
      .on_hidden = {}};
  const Status encoded =
      model.encoder.encode(samples, encoding, [&](const Tensor& features) { windows.push_back(features); });
  if (!encoded) return encoded.error();
  const Tensor features = Operations<Tensor>::concat_rows(windows);
  Result<Tensor> pairs(group_rows(rows(features, 0, features.num_rows() / 2 * 2), 2));
  if (is_long) pairs.warnings.push_back(windows_warning(speech_s));
  return pairs;
}

Status check(const DrawOptions& draw, const Sizes& sizes) {
  if (!(draw.temperature >= 0 && draw.temperature <= 1e6) ||
      !(draw.noise_factor >= 0 && draw.noise_factor <= 1e6))
    return Error{Errc::usage, "--temperature, --noise", "must be between 0 and a million", ""};
  if (!sizes.is_variational() && (draw.place < 1 || draw.place > sizes.num_codes))
    return Error{Errc::usage, "--draw " + std::to_string(draw.place),
                 "must be one of the " + std::to_string(sizes.num_codes) + " codes, counted from 1", ""};
  return Done{};
}

}  // namespace

Status animate(const FaceModel::Parts& model, SampleSource& speech, const FaceOptions& options, int num_takes,
               int num_threads, Progress& progress, const FrameSink& sink) {
  const Network<Tensor>& network = *model.probtalk3d;
  const Sizes& sizes = network.sizes;
  MIEN_TRY([[maybe_unused]] const auto checked, check(options.draw, sizes));
  MIEN_TRY(const std::vector<float> style, chosen_style(model.description, options));
  progress.stage("hearing", 0);
  MIEN_TRY(std::vector<float> samples, whole(speech, model.encoder.config()));
  const auto num_samples = static_cast<std::int64_t>(samples.size());
  const std::int64_t num_frames = model.encoder.config().num_frames(num_samples) / 2;
  if (num_frames < 2)  // the norm over time needs two
    return Error{Errc::input, "speech",
                 "is too short: " + std::to_string(num_samples) + " samples at 16 kHz give " +
                     std::to_string(num_frames) + " frames",
                 "At least two frames' time is needed"};
  if (!sizes.is_variational() && !network.prior.quantiser.fits(num_frames))
    return Error{Errc::incompatible, "model",
                 "has codes of " + std::to_string(sizes.code_width) + " numbers, into which " +
                     std::to_string(num_frames) + " frames of " + std::to_string(sizes.width) +
                     " cannot be cut",
                 ""};
  progress.stage("encoding", 0);
  const auto pairs = hear(model, std::move(samples), options, num_threads);
  if (!pairs) return pairs.error();
  contract(pairs->num_rows() == num_frames,
           "probtalk3d: the encoder gave other frames than its configuration says");
  if (progress.cancelled()) return Error{Errc::cancelled, "animating", "interrupted", ""};
  const Tensor weights({1, static_cast<std::int64_t>(style.size())}, style);
  const Takes takes(network, network.predictor(*pairs, weights), options.draw);

  progress.stage("animating", num_takes);
  // A few takes side by side at a time, so that memory does not grow with their number.
  const int most = std::max(num_threads, 1);
  for (int first = 0; first < num_takes; first += most) {
    if (progress.cancelled()) return Error{Errc::cancelled, "animating", "interrupted", ""};
    const int count = std::min(most, num_takes - first);
    std::vector<Tensor> motions(static_cast<std::size_t>(count));
    parallel_for(num_threads, count, [&](std::int64_t i) {
      Tensor& own = motions[static_cast<std::size_t>(i)];
      own = takes.take(performance_seed(options.seed, first + static_cast<int>(i)));
      if (model.description.scaler) undo_scaler(*model.description.scaler, own.values());
    });
    for (int i = 0; i < count; ++i) {
      const Status status = sink(first + i, motions[static_cast<std::size_t>(i)].values());
      if (!status) return status.error();
    }
    progress.update(first + count);
  }
  Status status = Done{};
  status.warnings = pairs.warnings;
  return status;
}

}  // namespace mien::probtalk3d
