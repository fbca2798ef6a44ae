#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/models/model_file.h"
#include "mien/train/face_sequence.h"
#include "mien/train/sound_options.h"

namespace mien::train {

/// What the style's weights of a performance tell: nothing, whose it is, or that with its emotion (8 columns)
/// and level (3).
enum class CorpusStyle { none, speaker, speaker_emotion_level };

struct CorpusDataOptions {
  SoundOptions sound{};
  double fps = 25;  ///< performances are drawn at 60 frames a second and resampled
  std::int64_t num_takes = 1;
  /// Whose performances count, in the order of the style columns; empty: everyone's, in the order of the ids.
  std::vector<std::string> subjects{};
  bool needs_neutral = false;  ///< the face at rest, which is zero
  CorpusStyle style = CorpusStyle::speaker_emotion_level;
};

struct CorpusData {
  FaceSequences sequences;
  std::vector<std::string> subjects;  ///< in the order of the style columns
  ModelOutput output;
  std::string description, licence;  ///< of the data, for the model file
};

/// ARKit's 52 curves of a corpus, in the order of arkit_names(), each performance with its style; its emotion
/// is 1 where it is not neutral. The items of `folder` are learnt from, except those of the split
/// "valid", which validate, as all of `validation` do (empty: no second folder). Every performance of a clip
/// is a sequence of its own; one of each clip validates. Errors: of reading (input); no item to learn from, a
/// corpus without sound (incompatible).
Result<CorpusData> corpus_data(const std::filesystem::path& folder, const std::filesystem::path& validation,
                               CorpusDataOptions options);

}  // namespace mien::train
