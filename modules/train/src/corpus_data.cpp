#include "mien/train/corpus_data.h"

#include <algorithm>
#include <memory>
#include <set>

#include "mien/core/arkit.h"
#include "mien/corpus/corpus_reader.h"
#include "mien/models/probtalk3d/conventions.h"
#include "sound_input.h"

namespace mien::train {
namespace {

// A performance to be drawn.
struct Performance {
  const CorpusReader* corpus;
  const CorpusItem* item;
  int take;
};

// What the closure of FaceSequences holds.
struct Source {
  std::vector<CorpusReader> corpora;
  CorpusDataOptions options;
  std::vector<Performance> train, valid;

  [[nodiscard]] std::vector<float> style_of(const CorpusItem& item) const {
    if (options.style == CorpusStyle::none) return {};
    const auto speaker = std::ranges::find(options.subjects, item.speaker) - options.subjects.begin();
    const auto num_speakers = static_cast<std::int64_t>(options.subjects.size());
    if (options.style == CorpusStyle::speaker) return one_hot_weights(speaker, num_speakers);
    return mien::probtalk3d::style_weights(
        speaker, num_speakers, static_cast<std::int64_t>(item.emotion), kNumEmotions, item.level - 1,
        static_cast<std::int64_t>(mien::probtalk3d::published_intensities().size()));
  }
  [[nodiscard]] Result<FaceSequence> load(const Performance& from) const {
    FaceSequence s;
    s.name = from.item->id;
    MIEN_TRY(s.waveform, heard_sound(from.corpus->audio_path(*from.item), options.sound));
    MIEN_TRY(const ItemTakes drawn, from.corpus->takes(*from.item, from.take + 1));
    const Motion motion = resample(drawn.takes.back(), options.fps);
    if (motion.num_channels() < static_cast<std::int64_t>(kNumArkit))
      return Error{Errc::input, "curves of '" + s.name + "'",
                   "hold " + std::to_string(motion.num_channels()) + " channels, not ARKit's 52", ""};
    for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
      const auto frame = motion.frame(n).first(kNumArkit);
      s.motion.insert(s.motion.end(), frame.begin(), frame.end());
    }
    s.style = style_of(*from.item);
    s.emotion = from.item->emotion == Emotion::neutral ? 0 : 1;
    if (options.needs_neutral) s.neutral.assign(kNumArkit, 0.0f);
    return s;
  }
  void add(bool validates) {
    const CorpusReader& corpus = corpora.back();
    for (const CorpusItem& item : corpus.items()) {
      if (!options.subjects.empty() &&
          std::ranges::find(options.subjects, item.speaker) == options.subjects.end())
        continue;
      const bool is_valid = validates || item.split == "valid";
      const auto count = static_cast<int>(is_valid ? 1 : options.num_takes);
      for (int take = 0; take < count; ++take) (is_valid ? valid : train).push_back({&corpus, &item, take});
    }
  }
};

Status check_channels(const CorpusReader& corpus, const std::filesystem::path& folder) {
  const auto names = arkit_names();
  const auto& channels = corpus.info().channels;
  if (channels.size() >= names.size() && std::ranges::equal(names, std::span(channels).first(names.size())))
    return Done{};
  return Error{Errc::incompatible, "corpus '" + folder.string() + "'",
               "has other channels than ARKit's 52 curves in their order", ""};
}

}  // namespace

Result<CorpusData> corpus_data(const std::filesystem::path& folder, const std::filesystem::path& validation,
                               CorpusDataOptions options) {
  const auto source = std::make_shared<Source>();
  source->options = std::move(options);
  source->corpora.reserve(2);  // performances point into them
  for (const auto* path : {&folder, &validation}) {
    if (path->empty()) continue;
    MIEN_TRY(CorpusReader corpus, CorpusReader::open(*path));
    MIEN_TRY([[maybe_unused]] const auto fits, check_channels(corpus, *path));
    source->corpora.push_back(std::move(corpus));
    auto& subjects = source->options.subjects;
    if (subjects.empty()) {  // of the first folder
      std::set<std::string> found;
      for (const CorpusItem& item : source->corpora.back().items()) found.insert(item.speaker);
      subjects.assign(found.begin(), found.end());
    }
    source->add(path == &validation);
  }
  const std::string name = "corpus '" + folder.string() + "'";
  if (source->train.empty())
    return Error{Errc::incompatible, name, "has no clip to learn from of the wanted subjects",
                 "Make one: mien corpus build -o " + folder.string() + " --split train"};
  const Performance& first = source->train.front();
  if (source->options.sound.encoder && !std::filesystem::exists(first.corpus->audio_path(*first.item)))
    return Error{Errc::incompatible, name, "has no sound", "Build it with --store audio"};
  CorpusData data;
  data.sequences = {source->train.size(), source->valid.size(), {}};
  data.subjects = source->options.subjects;
  data.output = {.space = "arkit",
                 .channels = static_cast<std::int64_t>(kNumArkit),
                 .fps = source->options.fps,
                 .topology = ""};
  data.description = "{\"layout\": \"corpus\"}";
  data.licence = "that of the corpus and of the speech encoder";
  data.sequences.load = [source](FaceSequences::Split split, std::size_t index) {
    return source->load((split == FaceSequences::Split::train ? source->train : source->valid).at(index));
  };
  return data;
}

}  // namespace mien::train
