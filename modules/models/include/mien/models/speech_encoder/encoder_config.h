#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/nn/parameters.h"

namespace mien {

/// Sizes and switches of a HuBERT or wav2vec 2.0 encoder under the names of the Hugging Face config.json,
/// with the library's defaults, which are the base model. Two fields of preprocessor_config.json and of the
/// system that uses the encoder travel along: do_normalize and normalise_eps.
struct EncoderConfig {
  std::string model_type = "hubert";  ///< or "wav2vec2": the same network
  std::int64_t hidden_size = 768;
  std::int64_t num_hidden_layers = 12;
  std::int64_t num_attention_heads = 12;
  std::int64_t intermediate_size = 3072;
  bool conv_layer_norm = false;  ///< feat_extract_norm: "layer" (a norm after every convolution), not "group"
  std::vector<std::int64_t> conv_dim = std::vector<std::int64_t>(7, 512);
  std::vector<std::int64_t> conv_kernel = {10, 3, 3, 3, 3, 2, 2};
  std::vector<std::int64_t> conv_stride = {5, 2, 2, 2, 2, 2, 2};
  bool conv_bias = false;
  std::int64_t num_conv_pos_embeddings = 128;
  std::int64_t num_conv_pos_embedding_groups = 16;
  bool do_stable_layer_norm =
      false;  ///< norms before each part of a layer and after the last, as in the large models
  bool feat_proj_layer_norm = true;  ///< false: DistilHuBERT
  double layer_norm_eps = 1e-5;

  // Training only.
  bool apply_spec_augment = true;
  double mask_time_prob = 0.05;
  std::int64_t mask_time_length = 10;
  std::int64_t mask_time_min_masks = 2;
  double mask_feature_prob = 0.0;
  std::int64_t mask_feature_length = 10;
  std::int64_t mask_feature_min_masks = 0;
  double hidden_dropout = 0.1;
  double activation_dropout = 0.1;
  double attention_dropout = 0.1;
  double feat_proj_dropout = 0.1;
  double layerdrop = 0.1;

  // The waveform: y = (x - mean) / sqrt(variance + eps). transformers used 1e-5 up to 4.10 and 1e-7
  // from 4.11.
  bool do_normalize = true;
  double normalise_eps = 1e-5;

  /// Samples that one frame sees, and from one frame to the next: 400 and 320 for the base kernels.
  [[nodiscard]] std::int64_t receptive_field() const;
  [[nodiscard]] std::int64_t hop() const;
  /// Frames of `num_samples` samples; 0 below receptive_field().
  [[nodiscard]] std::int64_t num_frames(std::int64_t num_samples) const;
  /// Frames per second of the convolutions' output: 50.
  [[nodiscard]] double frame_rate_hz() const { return 16000.0 / static_cast<double>(hop()); }

  /// Error (Errc::incompatible) naming the field and the reason: sizes below 1 or absurd, lists of different
  /// length, heads or groups that do not divide the hidden size, probabilities outside [0, 1).
  [[nodiscard]] Status validate() const;

  friend bool operator==(const EncoderConfig&, const EncoderConfig&) = default;
};

/// Reads config.json (unknown fields are ignored, absent ones keep their default) and validates. Also reads
/// the two fields of our own, as to_json() writes them. Errors (Errc::incompatible), each naming the field:
/// not hubert or wav2vec2, batch norm at the positional convolution, adapters, another activation than gelu,
/// a value of the wrong type, and what validate() finds.
Result<EncoderConfig> encoder_config_from_json(std::string_view json);
/// Takes do_normalize from preprocessor_config.json. Error (Errc::incompatible): broken JSON, a rate other
/// than 16 kHz.
Status read_preprocessor_config(std::string_view json, EncoderConfig& config);
std::string to_json(const EncoderConfig& config);

/// The configuration that the shapes of an encoder's tensors imply (names without prefix), for weights
/// without a config.json. Strides are those of the base model; heads follow from the hidden size (12 for 768,
/// 16 for 1024 and 1280); the stable form is the one whose second convolution has a norm. Errors
/// (Errc::incompatible): a needed tensor is absent, or the sizes are not those of a known family.
Result<EncoderConfig> encoder_config_from_shapes(const std::map<std::string, Shape>& shapes);

}  // namespace mien
