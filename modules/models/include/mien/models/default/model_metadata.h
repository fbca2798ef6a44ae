#pragma once
#include <map>
#include <string>

#include "mien/base/result.h"
#include "mien/models/default/network.h"

namespace mien::default_model {

/// What a model file says of itself, beside its weights: the JSON under "mien.model" in the safetensors
/// metadata.
struct ModelMetadata {
  /// 2: with a brow path. Version 1, without, still loads: diffusion makes its raises.
  static constexpr int kFormatVersion = 2;
  std::string name;
  Sizes sizes;
  std::int64_t look_ahead_mel_frames = 14;
  std::string training_config;  ///< the TOML text it was trained with
  std::string training_set;     ///< the set's own description, JSON
};

/// Delay of a frame after its instant, in milliseconds: the encoder's shift, the upper neighbour of the
/// interpolation from 100 Hz to 60 fps (6.7), half a mel window (12.5) and the smoother (33.3).
double look_ahead_ms(const ModelMetadata& metadata);

std::map<std::string, std::string> to_metadata(const ModelMetadata& metadata);
/// Errors (Errc::incompatible): not a model of Mien, another architecture, a newer format version, sizes out
/// of range.
Result<ModelMetadata> from_metadata(const std::map<std::string, std::string>& metadata);

}  // namespace mien::default_model
