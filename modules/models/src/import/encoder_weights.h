#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "imported_tensor.h"
#include "mien/models/speech_encoder/encoder_config.h"
#include "weights_source.h"

namespace mien {

/// An encoder found among weights, under the names of the Hugging Face library without prefix.
struct FoundEncoder {
  std::string prefix;  ///< in the weights: "", "wav2vec2.", "module.audio_encoder." ...
  std::vector<ImportedTensor> tensors;
  [[nodiscard]] std::map<std::string, Shape> shapes() const;
};

/// The encoder in `weights`: any prefix before feature_extractor.conv_layers, both spellings of weight norm
/// and the folded weight, fairseq's names. Nothing when there is none. Error (Errc::incompatible): two
/// encoders.
Result<std::optional<FoundEncoder>> find_encoder(const WeightsSource& weights, const std::string& file);

/// Keeps of `found` what the network of `config` has. Errors (Errc::incompatible) naming every missing
/// tensor and wrong shape. A missing masked_spec_embed only warns.
Result<std::vector<ImportedTensor>> encoder_tensors(const FoundEncoder& found, const EncoderConfig& config,
                                                    const std::string& file);

/// config.json and, when it is there, preprocessor_config.json of a Hugging Face folder; or one config.json.
/// Nothing when a folder has none. Errors as encoder_config_from_json().
Result<std::optional<EncoderConfig>> read_encoder_config(const std::filesystem::path& path);

}  // namespace mien
