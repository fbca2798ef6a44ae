#pragma once
#include "mien/models/face_model.h"
#include "mien/models/model_file.h"

namespace mien::probtalk3d {

/// The style weights [identities | emotions | intensities] that options ask of a model. An emotion may carry
/// its intensity: "happy:3" (level 1, 2, 3) or "happy:high". Without one it is medium, and for neutral low,
/// the only intensity that data has of it. Default: the first identity, neutral. Errors (Errc::usage):
/// unknown names.
Result<std::vector<float>> chosen_style(const ModelFile& model, const FaceOptions& options);

}  // namespace mien::probtalk3d
