#include "mien/models/animate.h"

#include <algorithm>
#include <array>

#include "mien/base/parallel.h"
#include "mien/core/arkit.h"

namespace mien {
namespace {

constexpr std::size_t kBlock = kModelSampleRateHz;  // 1 s of sound at a time

// Appends all frames that are ready.
void drain(DefaultStream& stream, Motion& motion) {
  std::array<float, DefaultStream::kNumChannels> frame;
  while (stream.pop(frame)) motion.values.insert(motion.values.end(), frame.begin(), frame.end());
}

}  // namespace

Result<Motion> animate(const DefaultModel& model, const AudioClip& clip, const PerformOptions& options,
                       Progress& progress) {
  contract(clip.sample_rate_hz == kModelSampleRateHz, "animate: the clip must be at 16 kHz");
  if (clip.samples.size() < kMinAudioSamples)
    return Error{Errc::input, "speech",
                 "is too short: " + std::to_string(clip.samples.size()) + " samples at 16 kHz",
                 "At least 25 ms are needed"};
  Motion motion{MotionSpace::arkit, arkit_and_head_channels(), DefaultStream::kFps, {}};
  DefaultStream stream(model, options);
  progress.stage("animating", static_cast<std::int64_t>(clip.samples.size() / kModelSampleRateHz));
  for (std::size_t at = 0; at < clip.samples.size(); at += kBlock) {
    if (progress.cancelled()) return Error{Errc::cancelled, "animating", "interrupted", ""};
    stream.push(std::span(clip.samples).subspan(at, std::min(kBlock, clip.samples.size() - at)));
    drain(stream, motion);
    progress.update(static_cast<std::int64_t>(at / kModelSampleRateHz));
  }
  stream.finish();
  drain(stream, motion);
  return motion;
}

Result<std::vector<Motion>> animate(const DefaultModel& model, AudioReader& speech,
                                    const PerformOptions& options, int num_takes, int num_threads,
                                    Progress& progress) {
  contract(num_takes >= 1, "animate: at least one take is needed");
  std::vector<Motion> motions(static_cast<std::size_t>(num_takes),
                              Motion{MotionSpace::arkit, arkit_and_head_channels(), DefaultStream::kFps, {}});
  std::vector<DefaultStream> streams;
  for (int take = 0; take < num_takes; ++take) {
    PerformOptions own = options;
    own.seed = performance_seed(options.seed, take);
    streams.emplace_back(model, own);
  }
  const auto seconds = speech.info().seconds;
  progress.stage("animating", seconds ? static_cast<std::int64_t>(*seconds) : 0);
  std::vector<float> block(kBlock);
  for (std::int64_t second = 0;; ++second) {
    if (progress.cancelled()) return Error{Errc::cancelled, "animating", "interrupted", ""};
    MIEN_TRY(const std::size_t count, speech.read(block));
    parallel_for(num_threads, num_takes, [&](std::int64_t take) {
      DefaultStream& stream = streams[static_cast<std::size_t>(take)];
      if (count > 0) stream.push(std::span(block).first(count));
      if (count < block.size()) stream.finish();
      drain(stream, motions[static_cast<std::size_t>(take)]);
    });
    progress.update(second + 1);
    if (count < block.size()) break;
  }
  Result<std::vector<Motion>> result = std::move(motions);
  result.warnings = speech.warnings();
  return result;
}

}  // namespace mien
