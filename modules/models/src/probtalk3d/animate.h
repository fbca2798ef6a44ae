#pragma once
#include "mien/models/face_model.h"

namespace mien::probtalk3d {

/// animate() of face_model.h for ProbTalk3D. The whole clip is heard before its first frame is known, so it
/// is held in memory (at most kMostFrames frames), and the frames of a take arrive at once. @pre the model is
/// one
Status animate(const FaceModel::Parts& model, SampleSource& speech, const FaceOptions& options, int num_takes,
               int num_threads, Progress& progress, const FrameSink& sink);

}  // namespace mien::probtalk3d
