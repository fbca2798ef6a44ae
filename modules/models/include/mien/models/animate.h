#pragma once
#include <cstdint>

#include "mien/audio/load_audio.h"
#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/audio_clip.h"
#include "mien/core/motion.h"
#include "mien/models/default/stream.h"
#include "mien/models/frame_sink.h"
#include "mien/models/seeds.h"

namespace mien {

/// Speech to facial motion: 52 ARKit coefficients and 3 head angles at 60 fps.
/// Errors: a clip shorter than 25 ms (input), cancelled.
Result<Motion> animate(const DefaultModel& model, const AudioClip& clip, const PerformOptions& options,
                       Progress& progress);

/// A motion of the default model without frames.
[[nodiscard]] Motion empty_default_motion();

/// The same for a file that is read while it is animated: memory does not grow with its length. `num_takes`
/// performances in parallel on up to `num_threads` threads, with the seeds performance_seed(options.seed, k);
/// the result does not depend on the number of threads. Frames arrive every second of sound. Errors: those of
/// reader and sink, cancelled.
Status animate(const DefaultModel& model, AudioReader& speech, const PerformOptions& options, int num_takes,
               int num_threads, Progress& progress, const FrameSink& sink);

}  // namespace mien
