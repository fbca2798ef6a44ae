#pragma once
#include "mien/models/animate.h"
#include "mien/models/face_model.h"
#include "mien/models/said/said_model.h"
#include "mien/motion/kept_values.h"

namespace mien {

/// Makes a part of a motion anew (docs/editing.md): frames and channels that `kept` does not keep, from the
/// speech that the motion belongs to, `num_takes` times with other seeds. What is kept keeps its bits, and so
/// do channels that the model does not make; the rest goes with it. The seeds are an edit's own: the same
/// seed as that of animate() gives another performance.
/// @param kept  of this motion, [N, C]
/// Errors: speech whose length is not that of the motion, a motion that shares no channel with the model
/// (incompatible); those of animate().
Result<std::vector<Motion>> edit(const DefaultModel& model, AudioReader& speech, const Motion& motion,
                                 const KeptValues& kept, const PerformOptions& options, int num_takes,
                                 int num_threads, Progress& progress);

/// The same with a published system. FaceDiffuser masks its diffusion: what is kept is known at every step.
/// FaceXHuBERT has no randomness: a stretch becomes what it always is, and all takes are equal.
Result<std::vector<Motion>> edit(const FaceModel& model, const AudioClip& speech, const Motion& motion,
                                 const KeptValues& kept, const FaceOptions& options, int num_takes,
                                 int num_threads, Progress& progress);

/// The same with SAiD (paper, section 3.3): after every step what is kept is put back, noised to the level
/// reached.
/// @pre options.known and options.window are not set
Result<std::vector<Motion>> edit(const SaidModel& model, const AudioClip& speech, const Motion& motion,
                                 const KeptValues& kept, const SaidOptions& options, int num_takes,
                                 int num_threads, Progress& progress);

}  // namespace mien
