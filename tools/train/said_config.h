#pragma once
#include "config_fields.h"
#include "mien/train/said_training.h"
#include "training_config.h"

namespace mien::train {

/// Training of SAiD's denoiser: configs/said.toml documents the fields. What a file does not say is as
/// published.
struct SaidConfig {
  RunConfig run;
  EncoderChoice encoder;
  CorpusFields corpus;              ///< where the data are a corpus
  std::filesystem::path sound;      ///< folder of <person>/sentenceNN.wav; empty: beside the coefficients
  std::filesystem::path deviation;  ///< coeffs_std.csv, which differences are divided by; empty: they are not
  std::int64_t width = 192;         ///< of the denoiser
  std::int64_t projection = 0;      ///< width of the context; 0: that of the encoder, as it is
  bool has_alignment_bias = true;
  std::int64_t num_epochs = 100'000, warm_up_epochs = 5000;
  double learning_rate = 1e-5, average_decay = 0.9999;
  std::vector<std::string> frozen = {"audio_encoder"};
  std::int64_t checkpoint_every = 500;                                            ///< steps
  std::int64_t validate_every = 200, validation_passes = 50, export_every = 200;  ///< epochs; 0: never
  SaidTrainingOptions options;
};

/// Errors (Errc::usage): unknown or wrong fields, each with its line.
Result<SaidConfig> read_said_config(TomlFile& file);

}  // namespace mien::train
