#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/train/face_sequence.h"
#include "mien/train/sound_options.h"

namespace mien::train {

/// Whether a folder is a corpus that `mien corpus build` wrote (docs/corpus.md).
bool is_corpus(const std::filesystem::path& folder);

struct CorpusDataOptions {
  SoundOptions sound{};
  double fps = 25;  ///< performances are drawn at 60 frames a second and resampled
  std::int64_t num_takes = 1;
  /// Whose performances count, in the order of the style columns; empty: everyone's, in the order of the ids.
  std::vector<std::string> subjects{};
  bool needs_neutral = false;  ///< the face at rest, which is zero
};

struct CorpusData {
  FaceSequences sequences;
  std::vector<std::string> subjects;  ///< in the order of the style columns
};

/// ARKit's 52 curves of a corpus, in the order of arkit_names(), each performance with a style of speaker,
/// emotion (8 columns) and level (3). The items of `folder` are learnt from, except those of the split
/// "valid", which validate, as all of `validation` do (empty: no second folder). Every performance of a clip
/// is a sequence of its own; one of each clip validates. Errors: of reading (input); no item to learn from, a
/// corpus without sound (incompatible).
Result<CorpusData> corpus_data(const std::filesystem::path& folder, const std::filesystem::path& validation,
                               CorpusDataOptions options);

}  // namespace mien::train
