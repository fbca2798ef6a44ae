#include "item.h"

#include <cmath>
#include <cstring>
#include <numbers>

#include "filters.h"
#include "forked.h"
#include "mien/base/hash.h"
#include "mien/core/audio_clip.h"

namespace mien {
namespace {

// Seconds of a training item: a sentence that would make a long enough item too long is left out.
constexpr double kShortestItem = 12, kLongestItem = 20;
constexpr double kLongestOvershoot = 8;  // of items that are meant to be longer than that
constexpr double kRate = kModelSampleRateHz;

std::vector<float> modulated_noise(std::size_t count, Rng& rng) {
  const AddedNoise kind{rng.chance(0.5) ? NoiseKind::white : NoiseKind::brown, rng.uniform(0.7, 0.985), 0, 0};
  auto x = make_noise(kind, count, {}, rng);
  const double hz = rng.uniform(0.2, 4), depth = rng.uniform(0, 0.9),
               phase = rng.uniform(0, 2 * std::numbers::pi);
  for (std::size_t i = 0; i < count; ++i)
    x[i] *= static_cast<float>(
        0.06 * (1 + depth * std::sin(2 * std::numbers::pi * hz * static_cast<double>(i) / kRate + phase)));
  return x;
}

std::vector<float> faint_noise(std::size_t count, Rng& rng) {
  auto x = make_noise({NoiseKind::brown, rng.uniform(0.7, 0.985), 0, 0}, count, {}, rng);
  const auto level = static_cast<float>(std::pow(10.0, rng.uniform(-5, -3.2)));
  for (auto& v : x) v *= level;
  return x;
}

// Chords of a few decaying partials, as music or machines make.
std::vector<float> tones(std::size_t count, Rng& rng) {
  std::vector<float> x(count, 0.0f);
  for (std::size_t at = 0; at < count;) {
    const auto length = static_cast<std::size_t>(rng.uniform(0.15, 1.2) * kRate);
    const auto voices = 1 + rng.below(4);
    const double decay = rng.uniform(0.1, 2.0), glide = rng.chance(0.2) ? rng.uniform(-0.5, 0.5) : 0;
    for (std::uint64_t v = 0; v < voices; ++v) {
      const double hz = 110 * std::exp2(rng.uniform(0, 4)), level = rng.uniform(0.02, 0.1);
      for (std::size_t i = 0; i < length && at + i < count; ++i) {
        const double t = static_cast<double>(i) / kRate;
        const double edge = std::min(1.0, t / 0.01) * std::exp(-t / decay);
        x[at + i] +=
            static_cast<float>(level * edge * std::sin(2 * std::numbers::pi * hz * t * (1 + glide * t / 2)));
      }
    }
    at += length + static_cast<std::size_t>(rng.chance(0.3) ? rng.uniform(0, 0.5) * kRate : 0);
  }
  return x;
}

}  // namespace

Clip make_non_speech(NonSpeech kind, double seconds, Rng& rng) {
  const auto count = static_cast<std::size_t>(seconds * kRate);
  if (kind == NonSpeech::tones) return without_speech(tones(count, rng));
  if (kind == NonSpeech::silence) return without_speech(faint_noise(count, rng));
  return without_speech(modulated_noise(count, rng));
}

Result<Clip> speak_item(const ItemPlan& item, std::uint64_t seed) {
  Rng rng(hash_combine(hash_combine(hash64("speak item"), seed), hash64(item.id)));
  if (item.non_speech != NonSpeech::none) return make_non_speech(item.non_speech, item.target_seconds, rng);
  std::vector<Clip> parts;
  double total = 0;
  const double longest = std::max(kLongestItem, item.target_seconds + kLongestOvershoot);
  for (const auto& text : item.texts) {
    if (total >= item.target_seconds) break;
    ClipRequest request{item.engine, item.voice, text, item.speaking, item.emotion, item.intensity(), 0, 0};
    request.speaking.rate *= std::max(0.8, rng.normal(1, 0.04));  // nobody keeps one speed
    request.pad_before_s = parts.empty() ? rng.uniform(0.15, 0.5) : rng.uniform(0.05, 0.6);
    MIEN_TRY(auto clip, speak(request));
    if (total >= kShortestItem && total + clip.spoken.seconds > longest) break;
    total += clip.spoken.seconds;
    parts.push_back(std::move(clip));
  }
  if (parts.empty()) return Error{Errc::failed, item.id, "there is no sentence to speak", ""};
  parts.push_back(
      without_speech(std::vector<float>(static_cast<std::size_t>(rng.uniform(0.15, 0.5) * kRate), 0.0f)));
  auto clip = join_clips(std::move(parts));
  // The silence at the end is not what makes a question.
  clip.spoken.is_question = item.texts[clip.num_sentences - 1].find('?') != std::string::npos;
  return clip;
}

BabblePool make_babble_pool(const std::vector<ItemPlan>& items, std::size_t count, std::uint64_t seed,
                            int jobs) {
  std::vector<const ItemPlan*> speaking;
  for (const auto& item : items)
    if (item.non_speech == NonSpeech::none && !item.texts.empty() && item.split == TextSplit::train)
      speaking.push_back(&item);
  BabblePool pool;
  if (speaking.empty()) return pool;
  const auto work = [&](std::int64_t i) -> Result<Bytes> {
    Rng rng(hash_combine(hash_combine(hash64("babble pool"), seed), static_cast<std::uint64_t>(i)));
    const auto& item = *speaking[rng.below(speaking.size())];
    const auto& text = item.texts[rng.below(item.texts.size())];
    MIEN_TRY(auto clip,
             speak({item.engine, item.voice, text, item.speaking, item.emotion, item.intensity(), 0.1, 0.1}));
    normalise_loudness(clip.samples);
    const auto bytes = std::as_bytes(std::span(clip.samples));
    return Bytes(bytes.begin(), bytes.end());
  };
  const auto take = [&](std::int64_t, Result<Bytes> bytes) -> Status {
    if (!bytes.has_value()) return Done{};  // one voice less in the crowd
    std::vector<float> samples(bytes->size() / sizeof(float));
    std::memcpy(samples.data(), bytes->data(), samples.size() * sizeof(float));
    pool.push_back(std::move(samples));
    return Done{};
  };
  (void)run_forked(jobs, static_cast<std::int64_t>(count), work, take);
  return pool;
}

}  // namespace mien
