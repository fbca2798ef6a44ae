#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/models/alignment.h"
#include "mien/models/speech_encoder/encoder_config.h"

namespace mien::train {

/// One recording that a published system learns from. S samples, N frames, D channels.
struct FaceSequence {
  std::string name;             ///< of the recording: the same name, the same sound
  std::vector<float> waveform;  ///< [S] 16 kHz, as the encoder wants it; empty where nothing is heard
  std::vector<float> motion;    ///< [N, D]
  std::vector<float> neutral;   ///< [D]; empty for the systems without
  std::vector<float> style;     ///< weights of the style's columns; empty for the systems without
  std::int64_t emotion = 0;     ///< of FaceXHuBERT
};

/// Zeros, and a 1 at `index`. @pre 0 <= index < count
std::vector<float> one_hot_weights(std::int64_t index, std::int64_t count);

/// The recordings of a data set. They are loaded when needed: meshes of a data set do not fit into memory.
struct FaceSequences {
  std::size_t num_train = 0, num_valid = 0;
  enum class Split { train, valid };
  /// Error: of reading the files.
  std::function<Result<FaceSequence>(Split split, std::size_t index)> load;
};

/// Frames of a motion of `width` numbers a frame. Error (Errc::incompatible): none, or no whole ones.
Result<std::int64_t> num_frames_of(const FaceSequence& sequence, std::int64_t width);
/// How its sound meets its frames. Errors (Errc::incompatible): no whole frames, sound that is too short for
/// one.
Result<Alignment> align_sequence(const FaceSequence& sequence, std::int64_t width,
                                 const EncoderConfig& encoder, double fps);

}  // namespace mien::train
