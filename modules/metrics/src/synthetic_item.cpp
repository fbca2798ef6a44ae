#include "synthetic_item.h"

#include <algorithm>

#include "mien/base/contract.h"
#include "mien/base/hash.h"
#include "mien/base/parallel.h"
#include "mien/corpus/take.h"
#include "mien/metrics/utterance_labels.h"

namespace mien {
namespace {

constexpr std::size_t kMaxJudgedTrueTakes = 8;  // enough for a ceiling
constexpr std::uint64_t kTrainingSalt =
    0x636f6e646974696f;  // training takes differ from the true takes of an item

// What the truth and the generated takes have in common: one of each per measure.
struct TakeScores {
  BlinkScore blinks;
  AccentScore brows, nods;
  GazeScore gaze;
  RestScore rest;
  ClosureScore closures;
};

TakeScores score_takes(std::span<const Motion> takes, const Utterance& utterance) {
  const SpeechLabels labels = labels_of(utterance);
  const std::vector<TimeInterval> pauses = pause_intervals(utterance);
  TakeScores out;
  for (const Motion& take : takes) {
    const Aperture aperture =
        curve_aperture(take, ApertureVariant::curves).value();  // a performance has both curves
    out.blinks += score_blinks(take, pauses);
    out.brows += score_accents(detect_brow_raises(take), utterance.accents_s, take.num_frames());
    out.nods += score_accents(detect_nods(take), utterance.accents_s, take.num_frames());
    out.gaze += score_gaze(take);
    out.rest += score_rest(aperture, labels, nullptr);
    out.closures += score_closures(aperture, labels, kClosureToleranceSeconds);
  }
  return out;
}

// A take to be drawn for training a classifier.
struct Condition {
  const Speaker* speaker;
  Emotion emotion;
  double intensity;
  int level;
};

std::vector<ConditionExample> draw_examples(const Utterance& utterance, std::span<const Condition> conditions,
                                            std::uint64_t seed, int threads) {
  std::vector<ConditionExample> out(conditions.size());
  parallel_for(threads, static_cast<std::int64_t>(conditions.size()), [&](std::int64_t i) {
    const Condition& c = conditions[static_cast<std::size_t>(i)];
    const std::uint64_t take = hash_combine(seed, static_cast<std::uint64_t>(i));
    out[static_cast<std::size_t>(i)].features =
        condition_features(draw_take(utterance, *c.speaker, c.emotion, c.intensity, take).motion);
  });
  return out;
}

void append(std::vector<ConditionExample>& to, const std::vector<ConditionExample>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

bool is_neutral(const CorpusItem& item) { return item.emotion == Emotion::neutral; }

int style_index(const Speaker& speaker) { return static_cast<int>(&speaker - fixed_speakers().data()); }

}  // namespace

ItemTruth draw_truth(const CorpusItem& item, const Speaker& speaker, Utterance utterance,
                     std::uint64_t corpus_seed, const SyntheticOptions& options) {
  ItemTruth truth{item, speaker, std::move(utterance), {}, {}};
  std::vector<Motion> takes(static_cast<std::size_t>(options.true_takes) + 1);
  parallel_for(options.threads, static_cast<std::int64_t>(takes.size()), [&](std::int64_t k) {
    takes[static_cast<std::size_t>(k)] =
        draw_take(truth.utterance, speaker, item.emotion, item.intensity(),
                  take_seed(corpus_seed, item.id, static_cast<std::uint64_t>(k)))
            .motion;
  });
  truth.held_out = std::move(takes.back());
  takes.pop_back();
  truth.takes = std::move(takes);
  return truth;
}

SyntheticItemScore score_item(const ItemTruth& truth, std::span<const Motion> samples) {
  SyntheticItemScore out;
  out.id = truth.item.id;
  const Motion conditional_mean = mean_motion(truth.takes), sample_mean = mean_motion(samples);
  out.lips = score_lips(conditional_mean, samples, 0);
  if (is_neutral(truth.item)) out.lips_neutral = score_lips(conditional_mean, samples, truth.speaker.press);
  for (std::size_t r = 0; r < kNumFaceRegions; ++r) {
    const FaceRegion region = kFaceRegions[r];
    out.diversity[r] = {pair_distance(samples, region), pair_distance(truth.takes, region)};
    out.smoothness[r] = {second_difference(samples, region), second_difference(truth.takes, region)};
    out.accuracy[r] = score_accuracy(sample_mean, conditional_mean, truth.held_out, region);
  }
  out.calibration = score_calibration(samples, truth.held_out, truth.takes);
  const TakeScores generated = score_takes(samples, truth.utterance),
                   real = score_takes(truth.takes, truth.utterance);
  out.blinks = {generated.blinks, real.blinks};
  out.brows = {generated.brows, real.brows};
  out.nods = {generated.nods, real.nods};
  out.gaze = {generated.gaze, real.gaze};
  out.rest = {generated.rest, real.rest};
  out.closures = {generated.closures, real.closures};
  return out;
}

void ConditionMaterial::append(const ConditionMaterial& other) {
  mien::append(emotion, other.emotion);
  mien::append(level, other.level);
  mien::append(style, other.style);
}

ConditionMaterial training_material(const ItemTruth& truth, std::uint64_t corpus_seed, int threads) {
  const std::uint64_t seed = hash_combine(hash_combine(corpus_seed, kTrainingSalt), hash64(truth.item.id));
  std::vector<Condition> poses = {{&truth.speaker, Emotion::neutral, 1, 1}};
  for (int e = 1; e < kNumEmotions; ++e)
    for (int level = 1; level <= 3; ++level)
      poses.push_back({&truth.speaker, static_cast<Emotion>(e), intensity_of_level(level), level});
  ConditionMaterial out;
  out.emotion = draw_examples(truth.utterance, poses, hash_combine(seed, 1), threads);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    ConditionExample& example = out.emotion[i];
    example.label = static_cast<int>(poses[i].emotion);
    example.variety = poses[i].level;
    if (poses[i].emotion != Emotion::neutral)
      out.level.push_back({example.features, example.variety, example.label});
  }
  if (!is_neutral(truth.item)) return out;
  std::vector<Condition> styles;
  for (const Speaker& speaker : fixed_speakers()) styles.push_back({&speaker, Emotion::neutral, 1, 1});
  out.style = draw_examples(truth.utterance, styles, hash_combine(seed, 2), threads);
  for (std::size_t s = 0; s < out.style.size(); ++s) out.style[s].label = static_cast<int>(s);
  return out;
}

ConditionMaterial judged_material(const ItemTruth& truth, std::span<const Motion> takes) {
  ConditionMaterial out;
  for (const Motion& take : takes.first(std::min(takes.size(), kMaxJudgedTrueTakes))) {
    const std::vector<double> features = condition_features(take);
    const auto emotion = static_cast<int>(truth.item.emotion);
    out.emotion.push_back({features, emotion, 0});
    if (is_neutral(truth.item))
      out.style.push_back({features, style_index(truth.speaker), 0});
    else
      out.level.push_back({features, truth.item.level, emotion});
  }
  return out;
}

}  // namespace mien
