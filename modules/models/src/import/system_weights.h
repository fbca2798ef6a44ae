#pragma once
#include <optional>
#include <string>
#include <vector>

#include "encoder_weights.h"
#include "mien/models/model_file.h"

namespace mien {

/// A system recognised by the names of its tensors, with the encoder's left aside.
struct FoundSystem {
  Architecture architecture = Architecture::speech_encoder;
  std::string prefix;                   ///< in the weights: "" or "module."
  std::vector<ImportedTensor> tensors;  ///< everything that is not the encoder's
};

/// @param wanted  a name of architecture_name(), or empty to tell by the tensors
/// Errors (Errc::incompatible): no network that is known; (Errc::usage): `wanted` is no system to import.
Result<FoundSystem> find_system(const WeightsSource& weights, const std::optional<FoundEncoder>& encoder,
                                const std::string& wanted, const std::string& file);

/// What shapes tell about a system's motion and training.
struct SystemFacts {
  std::int64_t channels = 0;
  std::int64_t num_subjects = 0;        ///< 0: the network has no styles
  std::int64_t num_steps = 0;           ///< of diffusion; 0: not told by shapes, or no diffusion
  std::int64_t condition = 0;           ///< speech features side by side in a frame; 0: hears nothing
  std::int64_t num_styles = 0;          ///< with emotions: identities, emotions and intensities together
  std::vector<ImportedTensor> tensors;  ///< those that the network has
};
/// Errors (Errc::incompatible): missing tensors and wrong shapes by name. Warnings: tensors left out.
/// @pre not a speech encoder
/// @param heads  attention heads of ProbTalk3D, which no tensor tells
Result<SystemFacts> system_facts(const FoundSystem& found, const std::string& file, std::int64_t heads);

}  // namespace mien
