#include "corpus_data.h"

#include <array>
#include <map>

#include "mien/audio/load_audio.h"
#include "mien/core/arkit.h"
#include "mien/datasets/prepared_files.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

// BEAT: neutral, happiness, anger, sadness, contempt, surprise, fear, disgust.
int beat_number(Emotion emotion) {
  constexpr std::array<int, kNumEmotions> kNumbers = {0, 1, 3, 5, 6, 7, 2, 4};  // in the order of Emotion
  return kNumbers[static_cast<std::size_t>(emotion)];
}

// Every second frame of `motion`, the columns of BEAT.
NpyArray beat_array(const Motion& motion) {
  const auto names = arkit_order(ArkitOrder::beat);
  NpyArray array{{0, static_cast<std::int64_t>(names.size())}, {}};
  for (std::int64_t n = 0; n < motion.num_frames(); n += 2, ++array.shape[0])
    for (const auto& name : names)
      array.values.push_back(
          motion.values[static_cast<std::size_t>(n) * motion.num_channels() + arkit_index(name)]);
  return array;
}

}  // namespace

Result<PrepareReport> prepare_corpus(const fs::path& folder, const fs::path& out, Progress& progress) {
  MIEN_TRY(const CorpusReader corpus, CorpusReader::open(folder));
  MIEN_TRY([[maybe_unused]] const auto made, datasets::make_folders(out));
  Result<PrepareReport> result{PrepareReport{}};
  std::map<std::pair<std::string, int>, int> index;
  progress.stage("items", static_cast<std::int64_t>(corpus.items().size()));
  std::int64_t done = 0;
  for (const CorpusItem& item : corpus.items()) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    const auto sound = load_audio(corpus.audio_path(item));
    if (!sound) return sound.error();
    auto takes = corpus.takes(item, 1);
    if (!takes) return within(takes.error(), "item '" + item.id + "'");
    const NpyArray motion = beat_array(takes->takes.front());
    progress.update(++done);
    if (motion.values.empty()) {
      result.warnings.push_back("'" + item.id + "' is left out: it has no frame");
      continue;
    }
    const int emotion = beat_number(item.emotion);
    const std::string number = std::to_string(++index[{item.speaker, emotion}]);
    const std::string name = item.speaker + "_" + std::to_string(emotion) + "_" + number;
    MIEN_TRY([[maybe_unused]] const auto moved, datasets::write_motion_array(out, name, motion));
    MIEN_TRY([[maybe_unused]] const auto heard, datasets::write_sound(out, name, *sound));
    ++result->num_sequences;
    result->num_frames += motion.shape[0];
  }
  return result;
}

}  // namespace mien
