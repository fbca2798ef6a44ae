#include "mien/models/animate.h"

#include <algorithm>
#include <array>

#include "default/hearing.h"
#include "default/performer.h"
#include "mien/base/parallel.h"
#include "mien/core/arkit.h"

namespace mien {
namespace {

constexpr std::size_t kBlock = kModelSampleRateHz;  // 1 s of sound at a time

// Appends all frames that are ready.
void drain(DefaultStream& stream, std::vector<float>& values) {
  std::array<float, DefaultStream::kNumChannels> frame;
  while (stream.pop(frame)) values.insert(values.end(), frame.begin(), frame.end());
}

// Appends all frames that are ready once this was heard too.
void perform(default_model::Performer& take, const default_model::Hearing& hearing,
             const default_model::Heard& heard, std::vector<float>& values) {
  take.hear(heard);
  std::array<float, DefaultStream::kNumChannels> frame;
  const auto is_over = [&] { return hearing.num_frames() >= 0 && take.next() >= hearing.num_frames(); };
  while (take.is_ready() && !is_over()) {
    take.compose(hearing, frame);
    values.insert(values.end(), frame.begin(), frame.end());
  }
}

}  // namespace

Motion empty_default_motion() {
  return {MotionSpace::arkit, arkit_and_head_channels(), DefaultStream::kFps, {}};
}

Result<Motion> animate(const DefaultModel& model, const AudioClip& clip, const PerformOptions& options,
                       Progress& progress) {
  contract(clip.sample_rate_hz == kModelSampleRateHz, "animate: the clip must be at 16 kHz");
  if (clip.samples.size() < kMinAudioSamples)
    return Error{Errc::input, "speech",
                 "is too short: " + std::to_string(clip.samples.size()) + " samples at 16 kHz",
                 "At least 25 ms are needed"};
  Motion motion = empty_default_motion();
  DefaultStream stream(model, options);
  progress.stage("animating", static_cast<std::int64_t>(clip.samples.size() / kModelSampleRateHz));
  for (std::size_t at = 0; at < clip.samples.size(); at += kBlock) {
    if (progress.cancelled()) return Error{Errc::cancelled, "animating", "interrupted", ""};
    stream.push(std::span(clip.samples).subspan(at, std::min(kBlock, clip.samples.size() - at)));
    drain(stream, motion.values);
    progress.update(static_cast<std::int64_t>(at / kModelSampleRateHz));
  }
  stream.finish();
  drain(stream, motion.values);
  return motion;
}

Status animate(const DefaultModel& model, AudioReader& speech, const PerformOptions& options, int num_takes,
               int num_threads, Progress& progress, const FrameSink& sink) {
  contract(num_takes >= 1, "animate: at least one take is needed");
  default_model::Hearing hearing(model);
  std::vector<default_model::Performer> takes;
  takes.reserve(static_cast<std::size_t>(num_takes));
  for (int take = 0; take < num_takes; ++take) {
    PerformOptions own = options;
    own.seed = performance_seed(options.seed, take);
    takes.emplace_back(model, own);
  }
  const auto seconds = speech.info().seconds;
  progress.stage("animating", seconds ? static_cast<std::int64_t>(*seconds) : 0);
  std::vector<float> block(kBlock);
  std::vector<Status> taken(takes.size(), Status(Done{}));
  default_model::Heard heard;
  for (std::int64_t second = 0;; ++second) {
    if (progress.cancelled()) return Error{Errc::cancelled, "animating", "interrupted", ""};
    MIEN_TRY(const std::size_t count, speech.read(block));
    if (count > 0) hearing.push(std::span(block).first(count));
    const bool is_last = count < block.size();
    if (is_last) hearing.finish();
    // All takes stand at the same frame. After the end there is no end to what can be heard.
    while ((!is_last || takes.front().next() < hearing.num_frames()) && hearing.hear(heard)) {
      parallel_for(num_threads, num_takes, [&](std::int64_t k) {
        const auto take = static_cast<std::size_t>(k);
        std::vector<float> frames;
        perform(takes[take], hearing, heard, frames);
        taken[take] = sink(static_cast<int>(take), frames);
      });
      hearing.forget_before(takes.front().next());
      for (const Status& status : taken)
        if (!status) return status.error();
    }
    progress.update(second + 1);
    if (is_last) return Done{};
  }
}

}  // namespace mien
