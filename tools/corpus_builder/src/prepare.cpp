#include "prepare.h"

#include <algorithm>
#include <cmath>

#include "forked.h"
#include "mien/audio/log_mel.h"
#include "mien/audio/running_level.h"
#include "mien/base/contract.h"
#include "mien/base/hash.h"
#include "mien/core/audio_clip.h"
#include "mien/corpus/take.h"
#include "set_writer.h"

namespace mien {
namespace {

constexpr double kFps = 60;
constexpr std::size_t kBabbleClips = 32;

void append_halves(std::vector<std::uint16_t>& out, std::span<const float> values) {
  out.reserve(out.size() + values.size());
  for (const float v : values) out.push_back(float_to_half(v));
}

// Sets frames n with start <= n / fps < end.
void paint(std::vector<std::uint8_t>& track, double start, double end, std::uint8_t value) {
  const auto first = static_cast<std::int64_t>(std::ceil(std::max(0.0, start) * kFps - 1e-9));
  for (std::int64_t n = first;
       n < static_cast<std::int64_t>(track.size()) && static_cast<double>(n) < end * kFps - 1e-9; ++n)
    track[static_cast<std::size_t>(n)] = value;
}

void paint_phones(PreparedEntry& entry, const Utterance& spoken) {
  constexpr double kFirstPart = 0.55;  // of a segment with two visemes
  for (const auto& phone : spoken.phones) {
    const auto first = static_cast<std::uint8_t>(phone.visemes.first);
    if (!phone.visemes.second) {
      paint(entry.viseme, phone.start_s, phone.end_s, first);
    } else {
      const double middle = phone.start_s + kFirstPart * phone.seconds();
      paint(entry.viseme, phone.start_s, middle, first);
      paint(entry.viseme, middle, phone.end_s, static_cast<std::uint8_t>(*phone.visemes.second));
    }
    if (phone.closure) paint(entry.closure, phone.closure->start_s, phone.closure->end_s, 1);
  }
  for (const double accent : spoken.accents_s) {
    const auto n = std::llround(accent * kFps);
    if (n >= 0 && n < entry.num_frames()) entry.accent[static_cast<std::size_t>(n)] = 1;
  }
}

// Amplitude in 1/255 at the frame of each raise's centre; the larger of two in one frame.
std::vector<std::uint8_t> raise_track(std::span<const BrowGesture> raises, std::size_t frames) {
  std::vector<std::uint8_t> track(frames, 0);
  for (const BrowGesture& raise : raises) {
    const double frame = std::floor(raise.centre_s * kFps);
    if (frame < 0 || frame >= static_cast<double>(frames)) continue;
    auto& slot = track[static_cast<std::size_t>(frame)];
    slot =
        std::max(slot, static_cast<std::uint8_t>(std::clamp(std::round(raise.amplitude * 255), 1.0, 255.0)));
  }
  return track;
}

}  // namespace

PreparedEntry make_entry(std::span<const float> samples, const Utterance& spoken, const ItemPlan& item,
                         int takes, std::uint64_t seed, std::string_view name) {
  PreparedEntry entry;
  const auto mel = log_mel(samples);
  append_halves(entry.mel, mel.values);
  entry.level = running_levels(mel);
  const auto frames = static_cast<std::size_t>(num_motion_frames(spoken.seconds, kFps));
  entry.viseme.assign(frames, 0);
  entry.closure.assign(frames, 0);
  entry.accent.assign(frames, 0);
  paint_phones(entry, spoken);
  entry.emotion = static_cast<std::uint8_t>(item.emotion);
  entry.intensity = static_cast<float>(item.intensity());
  entry.split = item.split == TextSplit::valid ? 1 : 0;
  entry.seconds = spoken.seconds;
  Rng styles(hash_combine(hash_combine(hash64("styles"), seed), hash64(name)));
  for (int k = 0; k < takes; ++k) {
    PreparedTake out;
    out.style = static_cast<std::uint8_t>(styles.below(kNumTrainingStyles));
    const auto take = draw_take(spoken, fixed_speakers()[out.style], item.emotion, item.intensity(),
                                take_seed(seed, name, static_cast<std::uint64_t>(k)));
    contract(take.without_events.num_frames() == static_cast<std::int64_t>(frames),
             "make_entry: frames of the take");
    out.latents = take.latents;
    append_halves(out.curves, take.without_events.values);
    out.blink = blink_onsets(take.blinks, static_cast<std::int64_t>(frames), kFps);
    out.raise = raise_track(take.raises, frames);
    entry.takes.push_back(std::move(out));
  }
  return entry;
}

Result<std::vector<PreparedEntry>> prepare_item(const ItemPlan& item, const PrepareSetOptions& options,
                                                const BabblePool& pool) {
  const auto seed = options.plan.seed;
  MIEN_TRY(const Clip clip, speak_item(item, seed));
  std::vector<PreparedEntry> entries;
  for (int copy = 0; copy < options.copies; ++copy) {
    const std::string name = item.id + "/" + std::to_string(copy);
    Rng rng(hash_combine(hash_combine(hash64("augment copy"), seed), hash64(name)));
    const auto recipe = draw_training_recipe(rng);
    const auto samples = augment(clip.samples, recipe, pool);
    Utterance spoken = clip.spoken;
    stretch(spoken, recipe.time_factor);
    spoken.seconds = static_cast<double>(samples.size()) / kModelSampleRateHz;
    if (!std::all_of(samples.begin(), samples.end(), [](float v) { return std::isfinite(v); }))
      return Error{Errc::failed, name, "the augmented sound is not finite", ""};
    entries.push_back(make_entry(samples, spoken, item, options.takes, seed, name));
  }
  return entries;
}

Result<PrepareSummary> prepare_set(const std::filesystem::path& path, const PrepareSetOptions& options,
                                   Progress& progress) {
  MIEN_TRY(auto writer, SetWriter::create(path, options.takes));
  progress.stage("choosing sentences", 0);
  std::vector<std::string> missing;
  const auto items = plan_training(options.plan, missing);
  for (const auto& line : missing) progress.warn(line);
  if (items.empty())
    return Error{Errc::failed, "prepare", "no engine for training is present", "Install espeak-ng or flite"};
  const auto pool = make_babble_pool(items, kBabbleClips, options.plan.seed, options.jobs);

  PrepareSummary summary;
  progress.stage("speaking", static_cast<std::int64_t>(items.size()));
  const auto work = [&](std::int64_t i) -> Result<Bytes> {
    MIEN_TRY(const auto entries, prepare_item(items[static_cast<std::size_t>(i)], options, pool));
    Bytes bytes;
    for (const auto& e : entries) append_entry(bytes, e);
    return bytes;
  };
  const auto take = [&](std::int64_t i, Result<Bytes> bytes) -> Status {
    if (progress.cancelled()) return Error{Errc::cancelled, "prepare", "interrupted", ""};
    progress.update(i + 1);
    if (!bytes.has_value()) {
      ++summary.skipped;
      progress.warn("skipped: " + bytes.error().message());
      return Done{};
    }
    MIEN_TRY(const auto entries, parse_entries(*bytes));
    ++summary.items;
    for (const auto& e : entries) {
      summary.hours += e.seconds / 3600;
      summary.distinct_hours += e.seconds / 3600 / options.copies;
      MIEN_TRY(const Done added, writer.add(e));
      (void)added;
    }
    return Done{};
  };
  MIEN_TRY(const Done ran, run_forked(options.jobs, static_cast<std::int64_t>(items.size()), work, take));
  (void)ran;
  summary.entries = writer.num_entries();
  SetDescription description{options.plan.seed, summary.distinct_hours, {}};
  for (const auto* engine : available_engines())
    if (engine->id() != EngineId::festival) description.engines.push_back(engine->version());
  MIEN_TRY(const Done done, writer.finish(description, progress));
  (void)done;
  return summary;
}

}  // namespace mien
