#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/models/model_file.h"

namespace mien {

/// What `import_model` is told. Only the first source is needed.
struct ImportOptions {
  /// The weights: a file of torch.save, a .safetensors file or a Hugging Face folder. Behind it, in any
  /// order, what belongs to them: an encoder's folder, templates.pkl, a scaler's .pkl, region files (.txt).
  std::vector<std::filesystem::path> sources{};
  /// A Hugging Face folder or its config.json: the encoder's configuration, and its weights where the first
  /// source has none.
  std::filesystem::path encoder{};
  std::filesystem::path templates{};   ///< pickle of {subject: [V, 3]}
  std::filesystem::path scaler{};      ///< pickled MinMaxScaler of B-DAMM
  std::vector<std::string> regions{};  ///< "lve.txt" or "mouth=lve.txt"; lve is the mouth, fdd the upper face
  std::string system{};                ///< architecture_name(), when it cannot or shall not be told
  std::vector<std::string> subjects{};  ///< in training order, which is the order of the style columns
  std::optional<double> fps{};
  std::optional<std::int64_t> steps{};  ///< of diffusion, where shapes do not tell
  std::optional<std::int64_t> heads{};  ///< of ProbTalk3D's attention, where the checkpoint does not tell
  std::string schedule = "cosine";      ///< or "linear"
  bool half = false;                    ///< store weights as F16
};

struct ImportedModel {
  ModelFile description;
  std::int64_t num_tensors = 0;
  std::int64_t num_parameters = 0;
};

/// Writes one model file from the files that people have, without Python; see docs/import.md. It holds one
/// tensor in memory at a time and appears under its name when complete. Warnings: tensors left out, things
/// assumed. Errors: sources missing or damaged (input); of another system, wrong names or shapes, values that
/// are not finite, side files that do not fit (incompatible); an option that does not apply (usage); the
/// disk (failed); cancelled.
Result<ImportedModel> import_model(const ImportOptions& options, const std::filesystem::path& output,
                                   Progress& progress);

}  // namespace mien
