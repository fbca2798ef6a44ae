#pragma once
#include "config_fields.h"
#include "mien/models/probtalk3d/conventions.h"
#include "mien/train/probtalk3d_training.h"
#include "stopping_run.h"

namespace mien::train {

/// Training of ProbTalk3D's stage 1, with codes or a Gaussian latent: configs/probtalk3d_prior.toml documents
/// the fields. What a file does not say is as published.
struct ProbTalk3DPriorConfig {
  RunConfig run;
  CorpusFields corpus;
  mien::probtalk3d::Sizes sizes;  ///< but for the channels, which are those of the data
  std::int64_t num_expression = mien::probtalk3d::kNumExpression;  ///< of 3DMEAD
  std::int64_t num_epochs = 201, checkpoint_every = 500;
  double learning_rate = 1e-4, weight_decay = 0.01;
  StoppingFields stopping;
  probtalk3d::StageSettings options;
};

/// Training of stage 2: configs/probtalk3d.toml.
struct ProbTalk3DConfig {
  RunConfig run;
  CorpusFields corpus;
  EncoderChoice encoder;
  std::filesystem::path prior;        ///< a model file of stage 1
  std::vector<std::string> subjects;  ///< order of the style columns; empty: that of the data
  std::int64_t num_blocks = 12;       ///< of the predictor
  std::int64_t num_epochs = 201, checkpoint_every = 500;
  double learning_rate = 1e-5;
  std::vector<std::string> frozen;  ///< beside the prior
  StoppingFields stopping;
  probtalk3d::PredictorSettings options;
};

/// Errors (Errc::usage): unknown or wrong fields, each with its line.
Result<ProbTalk3DPriorConfig> read_probtalk3d_prior_config(TomlFile& file);
Result<ProbTalk3DConfig> read_probtalk3d_config(TomlFile& file);

}  // namespace mien::train
