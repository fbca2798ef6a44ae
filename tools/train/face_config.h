#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "config_fields.h"
#include "mien/models/model_file.h"
#include "mien/train/face_training.h"
#include "training_config.h"

namespace mien::train {

/// Training of a published system: configs/facexhubert.toml and configs/facediffuser_*.toml document the
/// fields. What a file does not say is as published.
struct FaceConfig {
  RunConfig run;
  Architecture architecture = Architecture::facexhubert;
  std::string layout;  ///< of the data set; empty: found from its names
  EncoderChoice encoder;
  std::vector<std::string> subjects;  ///< order of the style columns; empty: that of the data
  CorpusFields corpus;                ///< where the data are a corpus
  std::int64_t latent = 512;          ///< of the tokens; FaceXHuBERT has none
  std::int64_t hidden = 512;          ///< of the decoder
  DecoderSizes decoder;
  bool has_diffusion = true;  ///< of FaceDiffuser
  facediffuser::NoiseEncoder noise_encoder = facediffuser::NoiseEncoder::conv_max;
  std::int64_t num_epochs = 51;
  std::int64_t export_every = 25;  ///< epochs between models in the work folder; 0: none
  std::int64_t checkpoint_every = 500;
  double learning_rate = 1e-4;
  std::vector<std::string> frozen;
  FaceTrainingOptions options;

  /// FaceDiffuser V or its emotional form.
  [[nodiscard]] bool has_vertex_denoiser() const {
    return architecture == Architecture::facediffuser_v || architecture == Architecture::facediffuser_emotion;
  }
};

/// Errors (Errc::usage): unknown or wrong fields, each with its line.
Result<FaceConfig> read_face_config(TomlFile& file, Architecture architecture);

}  // namespace mien::train
