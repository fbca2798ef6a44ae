#pragma once
#include <filesystem>
#include <string>

#include "mien/io/safetensors.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/train/torch_operations.h"

namespace mien::train {

/// The speech encoder that a training starts from.
struct EncoderSource {
  SafetensorsFile file;
  EncoderConfig config;
  std::string name;  ///< of the file, for messages

  /// Fills the encoder of a network. Errors (Errc::incompatible): tensors that do not fit, by name.
  Status load_into(SpeechEncoder<torch::Tensor>& encoder) const;
};

/// Opens a model file with a speech encoder. Errors: not readable; no encoder in it, or one that masks
/// features in training when `spec_augment` is on (Errc::incompatible).
Result<EncoderSource> open_encoder(const std::filesystem::path& path, bool spec_augment);

}  // namespace mien::train
