#pragma once
#include <filesystem>
#include <string>

#include "mien/train/default_model.h"
#include "table_reader.h"

namespace mien::train {

/// What every training run has: the table [run].
struct RunConfig {
  std::string system = "default";  ///< or "facexhubert", "facediffuser_v" ...
  std::string name;
  std::filesystem::path data, output, work_folder;  ///< relative to the current folder
  std::uint64_t seed = 1;
  int num_threads = 2;
  std::string text;  ///< the file itself, kept in the model as provenance
  torch::Device device = torch::kCPU;

  void read(TomlFile& file);
  /// Sets the number of threads and makes the work folder. Error (Errc::failed): it cannot be made.
  [[nodiscard]] Status begin() const;
  /// Of a system that learns in one stage.
  [[nodiscard]] std::filesystem::path checkpoint() const { return work_folder / "checkpoint.safetensors"; }
};

/// Training of the default model: configs/default.toml documents the fields.
struct TrainingConfig {
  RunConfig run;
  default_model::Sizes sizes;
  DefaultTrainingOptions options;
  StageOptions mean, diffusion, blink, brow;
};

/// Errors (Errc::usage): unknown or wrong fields, each with its line.
Result<TrainingConfig> read_training_config(TomlFile& file);

}  // namespace mien::train
