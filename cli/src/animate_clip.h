#pragma once
#include <variant>

#include "animate_plan.h"
#include "mien/models/default/default_model.h"
#include "mien/models/face_model.h"
#include "mien/models/said/said_model.h"

namespace mien {

/// The model that performs.
using Performer = std::variant<DefaultModel, FaceModel, SaidModel>;

/// Errors: those of loading a model.
Result<Performer> load_performer(const AnimateArguments& arguments, const AnimatePlan& plan);

/// Animates one recording and writes all its outputs, or none of those that are motion files. Frames go to
/// the files as they are made where the formats allow it.
/// @return seconds of speech. Errors: what can be wrong with the recording (input), writing (failed), words
/// that the model does not know (usage), cancelled
Result<double> animate_clip(const AnimateArguments& arguments, const AnimatePlan& plan,
                            const Performer& performer, const ClipPlan& clip, ConsoleProgress& progress);

}  // namespace mien
