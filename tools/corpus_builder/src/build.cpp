#include "build.h"

#include <cmath>
#include <cstring>

#include "audio_file.h"
#include "forked.h"
#include "item.h"
#include "mien/base/file.h"
#include "mien/base/hash.h"
#include "mien/core/arkit.h"
#include "mien/core/audio_clip.h"
#include "mien/corpus/corpus_reader.h"
#include "mien/corpus/curve_file.h"
#include "mien/corpus/take.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

constexpr double kFps = 60;
constexpr int kMeanTakes = 64;  // of the approximate conditional mean (spec section 13)
constexpr std::size_t kSamplesPerTick =
    16;  // clips last whole milliseconds: exact in the four decimals of the files

// The parts of a clip on their way from the process that made it, each with its length before it.
void append_part(Bytes& bytes, std::span<const std::byte> part) {
  append_le(bytes, static_cast<std::uint64_t>(part.size()));
  bytes.insert(bytes.end(), part.begin(), part.end());
}
Result<std::vector<Bytes>> parse_parts(std::span<const std::byte> bytes) {
  std::vector<Bytes> parts;
  while (!bytes.empty()) {
    const auto size = read_le<std::uint64_t>(bytes, 0);
    if (!size || *size > bytes.size() - sizeof(*size))
      return Error{Errc::failed, "clip", "its bytes end too early", ""};
    const auto part = bytes.subspan(sizeof(*size), *size);
    parts.emplace_back(part.begin(), part.end());
    bytes = bytes.subspan(sizeof(*size) + *size);
  }
  return parts;
}

AugmentRecipe recipe_of(const BuildOptions& options, const std::string& id) {
  AugmentRecipe recipe;  // brings the loudness to its standard in any case
  recipe.seed = hash_combine(options.plan.seed, hash64(id));
  if (options.reverb_rt60_s) recipe.reverb = Reverb{*options.reverb_rt60_s, 0.25};
  if (options.noise_snr_db) recipe.noise = AddedNoise{NoiseKind::white, 0, 0, *options.noise_snr_db};
  return recipe;
}

CurveSet draw_curves(const Utterance& spoken, const CorpusItem& item, const BuildOptions& options) {
  const auto& speaker = *find_speaker(item.speaker);
  const auto mean_seed = hash_combine(hash64("mean"), take_seed(options.plan.seed, item.id, 0));
  std::vector<Motion> motions = {
      mean_performance(spoken, speaker, item.emotion, item.intensity(), mean_seed, kMeanTakes)};
  for (int k = 0; k < options.takes; ++k)
    motions.push_back(draw_take(spoken, speaker, item.emotion, item.intensity(),
                                take_seed(options.plan.seed, item.id, static_cast<std::uint64_t>(k)))
                          .motion);
  return curve_set(motions, true);
}

// Index line, phones, accents, sound, curves (the last two may be empty).
Result<Bytes> make_clip(const BuildItem& planned, const BuildOptions& options) {
  MIEN_TRY(Clip clip, speak_item(planned.plan, options.plan.seed));
  clip.samples.resize((clip.samples.size() + kSamplesPerTick - 1) / kSamplesPerTick * kSamplesPerTick, 0.0f);
  clip.spoken.seconds = static_cast<double>(clip.samples.size()) / kModelSampleRateHz;
  round_to_file(clip.spoken);
  CorpusItem item;
  item.id = planned.plan.id;
  item.split = split_name(options.plan.split);
  item.engine = engine_name(planned.plan.engine);
  item.voice = planned.plan.voice;
  item.language = planned.language;
  item.speaker = planned.speaker;
  item.emotion = planned.plan.emotion;
  item.level = std::max(1, planned.plan.level);
  item.seconds = clip.spoken.seconds;
  item.num_frames = num_motion_frames(item.seconds, kFps);
  item.is_question = clip.spoken.is_question;
  for (std::size_t i = 0; i < clip.num_sentences; ++i)
    item.text += (i > 0 ? " " : "") + planned.plan.texts[i];

  Bytes bytes;
  append_part(bytes, as_bytes(format_items(std::span(&item, 1))));
  append_part(bytes, as_bytes(format_phones(clip.spoken.phones)));
  append_part(bytes, as_bytes(format_accents(clip.spoken.accents_s)));
  if (options.store == Store::items) return bytes;
  append_part(bytes,
              std::as_bytes(std::span<const float>(augment(clip.samples, recipe_of(options, item.id), {}))));
  if (options.store == Store::curves)
    append_part(bytes, encode_curves(draw_curves(clip.spoken, item, options), CurvePrecision::half));
  return bytes;
}

class FolderWriter {
 public:
  explicit FolderWriter(const fs::path& folder) : folder_(folder), partial_(folder) {
    partial_ += ".partial";
  }
  FolderWriter(const FolderWriter&) = delete;
  FolderWriter& operator=(const FolderWriter&) = delete;
  ~FolderWriter() {
    std::error_code ignored;
    if (started_) fs::remove_all(partial_, ignored);
  }

  Status start() {
    std::error_code error;
    if (fs::exists(folder_, error))
      return Error{Errc::usage, "'" + folder_.string() + "'", "it exists already",
                   "Remove it or choose another name"};
    fs::remove_all(partial_, error);
    for (const char* part : {"phones", "accents", "audio", "curves"})
      fs::create_directories(partial_ / part, error);
    if (error) return Error{Errc::failed, "'" + partial_.string() + "'", error.message(), ""};
    started_ = true;
    return Done{};
  }

  Status add(const std::vector<Bytes>& parts, const CorpusItem& item, bool flac) {
    MIEN_TRY([[maybe_unused]] const Done phones,
             write_file(partial_ / "phones" / (item.id + ".tsv"), parts[1]));
    MIEN_TRY([[maybe_unused]] const Done accents,
             write_file(partial_ / "accents" / (item.id + ".txt"), parts[2]));
    if (parts.size() > 3) {
      std::vector<float> samples(parts[3].size() / sizeof(float));
      std::memcpy(samples.data(), parts[3].data(), samples.size() * sizeof(float));
      const auto path = partial_ / "audio" / (item.id + (flac ? ".flac" : ".wav"));
      MIEN_TRY([[maybe_unused]] const Done audio, write_audio(path, samples));
    }
    if (parts.size() > 4) return write_file(curve_path(partial_, item.id), parts[4]);
    return Done{};
  }

  Status finish(const CorpusInfo& info, const std::vector<CorpusItem>& items) {
    MIEN_TRY([[maybe_unused]] const Done index, write_index(partial_, info, items));
    std::error_code error;
    for (const char* part : {"audio", "curves"})
      if (fs::is_empty(partial_ / part, error)) fs::remove(partial_ / part, error);
    fs::rename(partial_, folder_, error);
    if (error) return Error{Errc::failed, "'" + folder_.string() + "'", error.message(), ""};
    started_ = false;
    return Done{};
  }

 private:
  fs::path folder_, partial_;
  bool started_ = false;
};

CorpusInfo info_of(const BuildOptions& options, const std::vector<CorpusItem>& items) {
  CorpusInfo info;
  info.seed = options.plan.seed;
  info.fps = kFps;
  info.channels = arkit_and_head_channels();
  info.generator_hash = generator_hash();
  for (const auto* engine : available_engines())
    info.engines[std::string(engine_name(engine->id()))] = engine->version();
  for (const auto& item : items) ++info.items_of_split[item.split];
  return info;
}

}  // namespace

Result<BuildSummary> build_corpus(const fs::path& folder, const BuildOptions& options, Progress& progress) {
  progress.stage("choosing sentences", 0);
  std::vector<std::string> missing;
  available_engines(&missing);
  for (const auto& line : missing) progress.warn(line);
  MIEN_TRY(const auto plan, plan_build(options.plan));
  FolderWriter writer(folder);
  MIEN_TRY([[maybe_unused]] const Done started, writer.start());

  BuildSummary summary;
  std::vector<CorpusItem> items;
  bool is_full = false;
  progress.stage("speaking", static_cast<std::int64_t>(plan.size()));
  const auto work = [&](std::int64_t i) { return make_clip(plan[static_cast<std::size_t>(i)], options); };
  const auto take = [&](std::int64_t i, Result<Bytes> bytes) -> Status {
    if (progress.cancelled()) return Error{Errc::cancelled, "build", "interrupted", ""};
    progress.update(i + 1);
    if (!bytes.has_value()) {
      ++summary.skipped;
      progress.warn("skipped: " + bytes.error().message());
      return Done{};
    }
    MIEN_TRY(const auto parts, parse_parts(*bytes));
    MIEN_TRY(const auto lines, parse_items(as_text(parts.at(0)), "clip"));
    const auto& item = lines.at(0);
    is_full =
        is_full || (options.limit_seconds > 0 && summary.seconds + item.seconds > options.limit_seconds);
    if (is_full) return Done{};
    ++summary.clips;
    summary.seconds += item.seconds;
    items.push_back(item);
    return writer.add(parts, item, options.flac);
  };
  MIEN_TRY([[maybe_unused]] const Done ran,
           run_forked(options.jobs, static_cast<std::int64_t>(plan.size()), work, take));
  if (items.empty()) return Error{Errc::failed, "build", "no clip was made", ""};
  MIEN_TRY([[maybe_unused]] const Done done, writer.finish(info_of(options, items), items));
  return summary;
}

}  // namespace mien
