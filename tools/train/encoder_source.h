#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "mien/io/safetensors.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/train/torch_operations.h"

namespace mien::train {

/// Which speech encoder a configuration wants: that of a model file, or a new one of these sizes.
struct EncoderChoice {
  std::filesystem::path file;
  std::optional<EncoderConfig> fresh;
};

/// The speech encoder that a training starts from.
struct EncoderSource {
  std::optional<SafetensorsFile> file;  ///< none: it keeps its random start
  EncoderConfig config;
  std::string name;  ///< of the file, for messages

  /// Fills the encoder of a network. Errors (Errc::incompatible): tensors that do not fit, by name.
  Status load_into(SpeechEncoder<torch::Tensor>& encoder) const;
};

/// Opens a model file with a speech encoder. Errors: not readable; no encoder in it, or one that masks
/// features in training when `spec_augment` is on (Errc::incompatible).
Result<EncoderSource> open_encoder(const EncoderChoice& choice, bool spec_augment);

}  // namespace mien::train
