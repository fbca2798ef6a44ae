#pragma once
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "animate_plan.h"
#include "mien/models/default/default_model.h"
#include "mien/models/face_model.h"
#include "mien/models/said/said_model.h"

namespace mien {

/// The model that performs.
using Performer = std::variant<DefaultModel, FaceModel, SaidModel>;

/// Errors: those of loading a model.
Result<Performer> load_performer(const AnimateArguments& arguments, const AnimatePlan& plan);

/// How many of the next recordings to animate side by side: as many short ones as FaceDiffuser gains from,
/// else 1.
std::size_t num_clips_together(const AnimateArguments& arguments, const Performer& performer,
                               std::span<const ClipPlan> next);

/// Animates recordings and writes all outputs of each, or none of those that are motion files. Frames go to
/// the files as they are made where the formats allow it.
/// @param clips  num_clips_together() of them
/// @return of each recording the seconds of its speech. Errors: what can be wrong with it (input), writing
/// (failed), words that the model does not know (usage), cancelled
std::vector<Result<double>> animate_clips(const AnimateArguments& arguments, const AnimatePlan& plan,
                                          const Performer& performer, std::span<const ClipPlan> clips,
                                          ConsoleProgress& progress);

/// Animates one take of a recording and draws several emotions of it together into the outputs of the plan's
/// clip: a sheet with a row for each (motion_sheet()), films and numbered pictures side by side.
/// @param plan  its emotion is changed @return seconds of speech. Errors: as animate_clips()
Result<double> show_emotions(const AnimateArguments& arguments, AnimatePlan& plan, const Performer& performer,
                             const std::vector<std::string>& emotions, ConsoleProgress& progress);

}  // namespace mien
