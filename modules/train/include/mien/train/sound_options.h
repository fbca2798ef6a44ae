#pragma once
#include <optional>

#include "mien/models/speech_encoder/encoder_config.h"

namespace mien::train {

/// How a system hears its data.
struct SoundOptions {
  std::optional<EncoderConfig> encoder;  ///< none: it learns from motion alone
  bool stretches = false;  ///< to -1 ... 1 before it is normalised (ProbTalk3D specification, section 3)
};

}  // namespace mien::train
