#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/corpus/corpus_files.h"

namespace mien {

/// Whether a folder is a corpus that `mien corpus build` wrote (docs/corpus.md).
bool is_corpus(const std::filesystem::path& folder);

/// Takes of one item, at 60 fps with the 55 channels of arkit_and_head_channels() (52 when stored without the
/// head).
struct ItemTakes {
  std::optional<Motion> mean;  ///< the mean curve, when it is stored
  std::vector<Motion> takes;
};

/// A corpus on disk (specification, section 12). Its curves are read where they are stored and drawn again
/// from phones where they are not, so callers need not know.
class CorpusReader {
 public:
  /// Reads corpus.json and items.tsv. Errors (Errc::input): missing or broken files.
  static Result<CorpusReader> open(const std::filesystem::path& folder);

  [[nodiscard]] const CorpusInfo& info() const { return info_; }
  [[nodiscard]] std::span<const CorpusItem> items() const { return items_; }

  /// Phones and accents of an item. Errors: missing or broken files.
  [[nodiscard]] Result<Utterance> utterance(const CorpusItem& item) const;

  /// Takes 0 ... count-1. Errors: broken files (Errc::input); curves that must be drawn, but were made by
  /// another version of the generator (Errc::incompatible). @pre count >= 0
  [[nodiscard]] Result<ItemTakes> takes(const CorpusItem& item, int count) const;

  /// 16 kHz .flac, or .wav when there is none; the file exists when the corpus was built with audio.
  [[nodiscard]] std::filesystem::path audio_path(const CorpusItem& item) const;

 private:
  std::filesystem::path folder_;
  CorpusInfo info_;
  std::vector<CorpusItem> items_;
};

/// Writes phones/<id>.tsv and accents/<id>.txt. Curves drawn later equal curves drawn now after
/// round_to_file().
Status write_utterance(const std::filesystem::path& folder, std::string_view id, const Utterance& utterance);

/// Writes items.tsv and corpus.json; corpus.json last, so a corpus without it is unfinished.
Status write_index(const std::filesystem::path& folder, const CorpusInfo& info,
                   std::span<const CorpusItem> items);

/// Where the curves of an item are stored: curves/<id>.pcv.
std::filesystem::path curve_path(const std::filesystem::path& folder, std::string_view id);

}  // namespace mien
