#pragma once
#include <filesystem>
#include <string>

#include "mien/train/default_model.h"

namespace mien::train {

/// Everything a training run is made of: configs/default.toml documents the fields.
struct TrainingConfig {
  std::string name;
  std::filesystem::path data, output, work_folder;  ///< relative to the current folder
  int num_threads = 2;
  default_model::Sizes sizes;
  DefaultTrainingOptions options;
  StageOptions mean, diffusion, blink, brow;
  std::string text;  ///< the file itself, kept in the model as provenance
};

/// Errors: unreadable file (input), bad TOML, unknown or wrong fields (usage), each with its line.
Result<TrainingConfig> load_training_config(const std::filesystem::path& path);

}  // namespace mien::train
