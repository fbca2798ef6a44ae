#pragma once
#include <memory>
#include <string>
#include <vector>

#include "mien/datasets/dataset.h"
#include "mien/models/speech_encoder/encoder_config.h"
#include "mien/train/face_sequence.h"

namespace mien::train {

struct FaceDataOptions {
  /// Whose sequences count, in the order of the style columns; empty: everyone's, and there are no styles.
  std::vector<std::string> subjects;
  bool needs_neutral = false;  ///< a template for every subject
};

/// The sequences of the splits train and val. Sound is what the encoder reads; the emotion is 1 for
/// expressive readings of BIWI, else 0. Errors (Errc::incompatible): no sequence to train on, a subject
/// without template.
Result<FaceSequences> face_sequences(std::shared_ptr<const Dataset> dataset, const EncoderConfig& encoder,
                                     FaceDataOptions options);

}  // namespace mien::train
