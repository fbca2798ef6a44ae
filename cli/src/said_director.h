#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "director.h"
#include "face_director.h"
#include "mien/models/said/said_model.h"

namespace mien {

/// The words of the command line that direct SAiD beside DirectionWords and FaceWords.
struct SaidWords {
  std::optional<double> guidance, rescale, strength;
  std::string init;  ///< a motion file to start from

  /// The first of them that was used, to tell that it does not apply to another model; empty: none.
  [[nodiscard]] std::string used() const;
};

/// --guidance, --guidance-rescale, --init and --strength. `said` outlives the command.
void add_said_options(CLI::App& command, SaidWords& said);

/// A motion as the start of a walk of the model: at its rate, its channels by name, those that are missing 0.
/// Keeps nothing yet. Warnings: channels that are missing or not the model's. Error (Errc::incompatible): no
/// channel of the model's.
Result<KeptValues> start_values(const Motion& motion, const Motion& model_motion);

/// Diffusion steps that the model was trained with; 1 where it does not say.
std::int64_t trained_steps(const ModelFile& model);

/// Steps default to all of the training, the sampler to ddim. Errors (Errc::usage): words of other models,
/// an unknown sampler, numbers out of range, --strength without --init.
Result<SaidOptions> said_options(const DirectionWords& words, const FaceWords& face, const SaidWords& said,
                                 std::int64_t trained_steps);

}  // namespace mien
