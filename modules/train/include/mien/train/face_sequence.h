#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mien/base/result.h"

namespace mien::train {

/// One recording that a published system learns from. S samples, N frames, D channels.
struct FaceSequence {
  std::string name;
  std::vector<float> waveform;  ///< [S] 16 kHz, normalised if the encoder wants it
  std::vector<float> motion;    ///< [N, D]
  std::vector<float> neutral;   ///< [D]; empty for the systems without
  std::int64_t subject = 0, emotion = 0;
};

/// The recordings of a data set. They are loaded when needed: meshes of a data set do not fit into memory.
struct FaceSequences {
  std::size_t num_train = 0, num_valid = 0;
  enum class Split { train, valid };
  /// Error: of reading the files.
  std::function<Result<FaceSequence>(Split split, std::size_t index)> load;
};

}  // namespace mien::train
