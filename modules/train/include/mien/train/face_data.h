#pragma once
#include <memory>
#include <string>
#include <vector>

#include "mien/datasets/dataset.h"
#include "mien/models/model_file.h"
#include "mien/train/face_sequence.h"
#include "mien/train/sound_options.h"

namespace mien::train {

struct FaceDataOptions {
  SoundOptions sound{};
  /// Whose sequences count, in the order of the style columns; empty: everyone's, and there are no styles.
  std::vector<std::string> subjects{};
  bool has_emotions = false;            ///< of 3DMEAD: the style has columns of emotion and intensity, too
  bool needs_neutral = false;           ///< a template for every subject
  std::int64_t num_expression = 0;      ///< of FLAME's parameters: the first so many expressions, and the jaw
  std::optional<ModelScaler> scaler{};  ///< applied to the motion
};

/// The sequences of the splits train and val. The emotion is 1 for expressive readings of BIWI, else 0.
/// Errors (Errc::incompatible): no sequence to train on, a subject without template.
Result<FaceSequences> face_sequences(std::shared_ptr<const Dataset> dataset, FaceDataOptions options);

}  // namespace mien::train
