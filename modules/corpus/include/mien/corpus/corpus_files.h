#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/corpus/emotion.h"
#include "mien/corpus/performance.h"

namespace mien {

// The text files of a corpus on disk (specification, section 12). Every parse_ function takes the content of
// a file and its name for messages; errors are Errc::input and name line and column.

/// One line of items.tsv.
struct CorpusItem {
  std::string id;  ///< also a file name: letters, digits, '_', '-', '.', not starting with '.'
  std::string split, engine, voice, language;
  std::string speaker;  ///< S00 ... S15
  Emotion emotion = Emotion::neutral;
  int level = 1;  ///< 1 ... 3
  double seconds = 0;
  std::int64_t num_frames = 0;  ///< num_motion_frames(seconds, 60)
  bool is_question = false;
  std::string text;

  [[nodiscard]] float intensity() const { return intensity_of_level(level); }
};

/// corpus.json: what the corpus was made from.
struct CorpusInfo {
  int version = 1;
  std::uint64_t seed = 0;
  double fps = 60;
  int sample_rate_hz = 16000;
  std::vector<std::string> channels = {};
  std::map<std::string, std::string> engines = {};  ///< name -> version
  std::uint64_t generator_hash = 0;                 ///< see generator_hash()
  std::map<std::string, std::int64_t> items_of_split = {};
};

/// Tabs and line ends in texts become spaces. @pre ids are valid
std::string format_items(std::span<const CorpusItem> items);
Result<std::vector<CorpusItem>> parse_items(std::string_view text, std::string_view name);

std::string format_phones(std::span<const PhoneSegment> phones);
/// Times must be finite, not negative, and in order.
Result<std::vector<PhoneSegment>> parse_phones(std::string_view text, std::string_view name);

std::string format_accents(std::span<const double> accents_s);
Result<std::vector<double>> parse_accents(std::string_view text, std::string_view name);

std::string format_info(const CorpusInfo& info);
Result<CorpusInfo> parse_info(std::string_view text, std::string_view name);

/// True when `id` can name an item.
bool is_valid_item_id(std::string_view id);

/// Rounds all numbers to the four decimals of the files, so that curves drawn before writing equal those
/// drawn after reading.
void round_to_file(Utterance& utterance);

}  // namespace mien
