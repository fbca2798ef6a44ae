#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/io/safetensors.h"
#include "mien/models/speech_encoder/encoder_config.h"

namespace mien {

/// The networks that a model file may hold.
enum class Architecture {
  default_model,
  speech_encoder,  ///< an encoder alone, to start training from
  facexhubert,
  facediffuser_v,
  facediffuser_beat,
  facediffuser_damm,
  said_vae,  ///< SAiD's motion codec, which measures motion and makes none from speech
  said,
  facediffuser_emotion,  ///< ProbTalk3D's form of V, with emotions and intensities
  probtalk3d,            ///< both stages; its Gaussian variant is told by its tensors
  probtalk3d_prior,      ///< stage 1 alone, to start the training of stage 2 from; has no speech encoder
};
/// "default", "speech_encoder", "facexhubert", "facediffuser_v", "facediffuser_beat", "facediffuser_damm",
/// "said_vae", "said", "facediffuser_emotion", "probtalk3d", "probtalk3d_prior"
std::string_view architecture_name(Architecture architecture);

/// What a frame of the model's motion is.
struct ModelOutput {
  std::string space;          ///< "arkit", "flame", "vertices" or "rig"
  std::int64_t channels = 0;  ///< 3 V for vertices
  double fps = 0;
  std::string topology;  ///< of vertices: "biwi", "flame", "multiface"; empty: unknown
};

/// The noise that a diffusion model was trained to remove.
struct ModelDiffusion {
  std::string schedule = "cosine";  ///< or "linear"
  std::int64_t steps = 0;
};

/// Range of the data set by channel: a value y of the model means (y - min) / scale.
struct ModelScaler {
  std::vector<double> scale, min;  ///< [channels]
};

/// Rows of channels as the model sees them, y = x scale + min, and back. In place; both operations are done
/// in double and rounded to float32, as scikit-learn does on float32 arrays. @pre whole rows
void apply_scaler(const ModelScaler& scaler, std::span<float> rows);
void undo_scaler(const ModelScaler& scaler, std::span<float> rows);

/// What a model file says of itself: the JSON under "mien.model" in its safetensors metadata. Weights lie
/// beside it under the names of the authors' checkpoints, a speech encoder's with the prefix
/// "audio_encoder."; neutral faces as "template.<subject>" [channels], regions of vertices as
/// "region.<name>" (I64 indices).
struct ModelFile {
  /// 2: the default model's brow path. Version 1, without, still loads.
  static constexpr int kFormatVersion = 2;
  static constexpr std::string_view kEncoderPrefix = "audio_encoder.";
  static constexpr std::string_view kTemplatePrefix = "template.";
  static constexpr std::string_view kRegionPrefix = "region.";

  int format_version = kFormatVersion;
  Architecture architecture = Architecture::default_model;
  std::string name;
  std::string input = {};  ///< the default model's features, in words
  ModelOutput output;      ///< no channels for a speech encoder
  std::optional<EncoderConfig> encoder;
  std::optional<ModelDiffusion> diffusion;
  std::optional<ModelScaler> scaler;
  /// Of layers that shapes do not tell: the default model's; "decoder_heads" of a transformer decoder;
  /// "heads" of ProbTalk3D;
  /// "alignment_bias" 0 of a SAiD that hears its whole clip at every frame.
  std::map<std::string, std::int64_t> sizes;
  std::string noise_encoder =
      {};  ///< of V-FaceDiffuser where it is not the published one: "conv_average", "mlp"
  std::optional<std::int64_t> look_ahead_mel_frames;
  std::optional<double> look_ahead_ms;   ///< of models that stream
  std::vector<std::string> styles;       ///< of the default model
  std::vector<std::string> subjects;     ///< in the order of the style columns
  std::vector<std::string> emotions;     ///< in the order of the emotion columns
  std::vector<std::string> intensities;  ///< in the order of their columns, weakest first
  std::string licence;
  std::string source;           ///< the file that it was imported from
  std::string training_config;  ///< the TOML text it was trained with
  std::string training_set;     ///< the set's own description, JSON
};

/// The description as safetensors metadata.
Metadata to_metadata(const ModelFile& model);
/// Errors (Errc::incompatible): no description, damaged, a newer format version, an unknown architecture, a
/// value out of range.
Result<ModelFile> read_model_file(const Metadata& metadata);

/// Subjects that have a neutral face in the file, in the order of the file.
std::vector<std::string> template_subjects(const SafetensorsFile& file);
/// The neutral face of a subject. Error (Errc::incompatible): there is none, naming those that there are.
Result<std::vector<float>> read_template(const SafetensorsFile& file, std::string_view subject);

/// The shape of every stored tensor, by name.
std::map<std::string, Shape> stored_shapes(const SafetensorsFile& file);

}  // namespace mien
