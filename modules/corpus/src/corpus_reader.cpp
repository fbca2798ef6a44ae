#include "mien/corpus/corpus_reader.h"

#include "mien/base/contract.h"
#include "mien/base/file.h"
#include "mien/corpus/curve_file.h"
#include "mien/corpus/take.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

fs::path phone_path(const fs::path& folder, std::string_view id) {
  return folder / "phones" / (std::string(id) + ".tsv");
}
fs::path accent_path(const fs::path& folder, std::string_view id) {
  return folder / "accents" / (std::string(id) + ".txt");
}

// Error of `read` applied to the content of a file, or its value.
template <class Parse>
auto parse_file(const fs::path& path, Parse&& parse)
    -> decltype(parse(std::string_view(), std::string_view())) {
  MIEN_TRY(const Bytes bytes, read_file(path));
  return parse(as_text(bytes), path.string());
}

Status make_folder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure)
    return Error{Errc::failed, "'" + folder.string() + "'", "cannot be made: " + failure.message(), ""};
  return Done{};
}

}  // namespace

bool is_corpus(const fs::path& folder) {
  std::error_code ec;
  return fs::exists(folder / "corpus.json", ec);
}

fs::path curve_path(const fs::path& folder, std::string_view id) {
  return folder / "curves" / (std::string(id) + ".pcv");
}

Result<CorpusReader> CorpusReader::open(const fs::path& folder) {
  CorpusReader reader;
  reader.folder_ = folder;
  MIEN_TRY(reader.info_, parse_file(folder / "corpus.json", parse_info));
  MIEN_TRY(reader.items_, parse_file(folder / "items.tsv", parse_items));
  return reader;
}

fs::path CorpusReader::audio_path(const CorpusItem& item) const {
  const fs::path flac = folder_ / "audio" / (item.id + ".flac");
  std::error_code ignored;
  return fs::exists(flac, ignored) ? flac : folder_ / "audio" / (item.id + ".wav");
}

Result<Utterance> CorpusReader::utterance(const CorpusItem& item) const {
  Utterance utterance;
  MIEN_TRY(utterance.phones, parse_file(phone_path(folder_, item.id), parse_phones));
  MIEN_TRY(utterance.accents_s, parse_file(accent_path(folder_, item.id), parse_accents));
  utterance.seconds = item.seconds;
  utterance.is_question = item.is_question;
  return utterance;
}

Result<ItemTakes> CorpusReader::takes(const CorpusItem& item, int count) const {
  contract(count >= 0, "CorpusReader::takes: count must not be negative");
  ItemTakes found;
  const fs::path stored = curve_path(folder_, item.id);
  std::error_code ignored;
  if (fs::exists(stored, ignored)) {
    MIEN_TRY(const CurveSet curves, read_curves(stored));
    if (curves.num_frames != item.num_frames || curves.fps != info_.fps)
      return Error{Errc::input, "curves '" + stored.string() + "'",
                   "hold " + std::to_string(curves.num_frames) + " frames, items.tsv says " +
                       std::to_string(item.num_frames),
                   ""};
    const std::int64_t first = curves.first_is_mean ? 1 : 0;
    if (curves.first_is_mean && curves.num_takes > 0) found.mean = curves.take(0);
    for (std::int64_t k = first; k < curves.num_takes && std::ssize(found.takes) < count; ++k)
      found.takes.push_back(curves.take(k));
  }
  if (std::ssize(found.takes) == count) return found;

  if (info_.generator_hash != generator_hash())
    return Error{Errc::incompatible, "corpus '" + folder_.string() + "'",
                 "its curves are not stored, and this version of the program would draw others",
                 "Build the corpus again, or store its curves"};
  const Speaker* speaker = find_speaker(item.speaker);
  if (speaker == nullptr)
    return Error{Errc::input, "item '" + item.id + "'", "speaker '" + item.speaker + "' is unknown",
                 "Speakers are S00 to S15"};
  MIEN_TRY(const Utterance said, utterance(item));
  for (auto k = static_cast<std::uint64_t>(found.takes.size()); k < static_cast<std::uint64_t>(count); ++k)
    found.takes.push_back(
        draw_take(said, *speaker, item.emotion, item.intensity(), take_seed(info_.seed, item.id, k)).motion);
  return found;
}

Status write_utterance(const fs::path& folder, std::string_view id, const Utterance& utterance) {
  contract(is_valid_item_id(id), "write_utterance: not an item id: " + std::string(id));
  for (const char* part : {"phones", "accents"}) {
    MIEN_TRY([[maybe_unused]] const Done made, make_folder(folder / part));
  }
  MIEN_TRY([[maybe_unused]] const Done phones,
           write_file(phone_path(folder, id), format_phones(utterance.phones)));
  return write_file(accent_path(folder, id), format_accents(utterance.accents_s));
}

Status write_index(const fs::path& folder, const CorpusInfo& info, std::span<const CorpusItem> items) {
  MIEN_TRY([[maybe_unused]] const Done made, make_folder(folder));
  MIEN_TRY([[maybe_unused]] const Done list, write_file(folder / "items.tsv", format_items(items)));
  return write_file(folder / "corpus.json", format_info(info));
}

}  // namespace mien
