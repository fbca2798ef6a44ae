#pragma once
#include "config_fields.h"
#include "mien/train/said_vae_training.h"
#include "training_config.h"

namespace mien::train {

/// Training of SAiD's motion codec: configs/said_vae.toml documents the fields. What a file does not say is
/// as published.
struct SaidVaeConfig {
  RunConfig run;
  CorpusFields corpus;              ///< where the data are a corpus
  std::filesystem::path deviation;  ///< coeffs_std.csv; empty: measured on the training sequences
  bool divides = true;              ///< differences by the deviation
  said::VaeSizes sizes;
  double learning_rate = 1e-4;
  double warm_up_share = 0.1;  ///< of all steps
  double average_decay = 0.99;
  std::int64_t checkpoint_every = 500;
  std::int64_t validate_every = 200;  ///< epochs
  VaeTrainingOptions options;
};

/// Errors (Errc::usage): unknown or wrong fields, each with its line.
Result<SaidVaeConfig> read_said_vae_config(TomlFile& file);

}  // namespace mien::train
