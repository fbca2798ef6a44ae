#include "mien/metrics/synthetic_benchmark.h"

#include <algorithm>
#include <numeric>

#include "mien/base/contract.h"
#include "mien/base/hash.h"
#include "mien/corpus/take.h"
#include "synthetic_item.h"

namespace mien {
namespace {

constexpr std::int64_t kMaxLengthDifference = 6;  // frames: rounding of the last analysis window

std::vector<const CorpusItem*> choose_items(std::span<const CorpusItem> all,
                                            const SyntheticOptions& options) {
  std::vector<const CorpusItem*> fitting, out;
  for (const CorpusItem& item : all)
    if (options.splits.empty() ||
        std::find(options.splits.begin(), options.splits.end(), item.split) != options.splits.end())
      fitting.push_back(&item);
  const auto count = static_cast<std::int64_t>(fitting.size());
  const std::int64_t wanted = options.max_items > 0 ? std::min(count, options.max_items) : count;
  for (std::int64_t i = 0; i < wanted; ++i)
    out.push_back(fitting[static_cast<std::size_t>(i * count / wanted)]);
  return out;
}

// A generated take with the length of the truth.
Result<Motion> prepare_sample(const Motion& sample, std::int64_t num_frames) {
  static const std::vector<std::string> channels = arkit_and_head_channels();
  const auto fail = [](const std::string& why) { return Error{Errc::incompatible, "motion", why, ""}; };
  if (sample.fps != kMetricFps) return fail("it is not at 60 frames/s");
  if (sample.channels != channels) return fail("it does not have the 52 ARKit and 3 head channels in order");
  MIEN_TRY(Motion motion, at_metric_rate(sample));
  const std::int64_t difference = motion.num_frames() - num_frames;
  if (motion.num_frames() == 0 || std::abs(difference) > kMaxLengthDifference)
    return fail("it has " + std::to_string(motion.num_frames()) + " frames, the truth " +
                std::to_string(num_frames));
  while (motion.num_frames() < num_frames) {
    const std::size_t width = channels.size(), last = motion.values.size() - width;
    for (std::size_t c = 0; c < width; ++c) motion.values.push_back(motion.values[last + c]);
  }
  motion.values.resize(static_cast<std::size_t>(num_frames) * channels.size());
  return motion;
}

Result<std::vector<Motion>> generate(const SyntheticSystem& system, const SyntheticRequest& request,
                                     std::int64_t num_frames) {
  MIEN_TRY(const std::vector<Motion> raw, system(request));
  if (raw.size() != request.take_seeds.size())
    return Error{Errc::incompatible, "motion",
                 "the system gave " + std::to_string(raw.size()) + " takes, expected " +
                     std::to_string(request.take_seeds.size()),
                 ""};
  std::vector<Motion> out;
  for (const Motion& motion : raw) {
    MIEN_TRY(Motion sample, prepare_sample(motion, num_frames));
    out.push_back(std::move(sample));
  }
  return out;
}

// One item and what its conditions are judged by.
struct ScoredItem {
  SyntheticItemScore score;
  ConditionMaterial training, generated, truth;
};

Result<ScoredItem> run_item(const CorpusReader& corpus, const CorpusItem& item, const SyntheticSystem& system,
                            const SyntheticOptions& options) {
  const Speaker* speaker = find_speaker(item.speaker);
  if (speaker == nullptr)
    return Error{Errc::incompatible, "speaker '" + item.speaker + "'", "is none of S00 ... S15", ""};
  MIEN_TRY(Utterance utterance, corpus.utterance(item));
  const ItemTruth truth = draw_truth(item, *speaker, std::move(utterance), corpus.info().seed, options);
  std::vector<std::uint64_t> seeds;
  for (int k = 0; k < options.samples; ++k)
    seeds.push_back(hash_combine(hash_combine(options.seed, hash64(item.id)), static_cast<std::uint64_t>(k)));
  MIEN_TRY(const std::vector<Motion> samples,
           generate(system, {item, corpus.audio_path(item), seeds}, truth.held_out.num_frames()));
  if (options.keep) {
    MIEN_TRY([[maybe_unused]] const auto kept,
             options.keep({item, corpus.audio_path(item), samples, truth.held_out}));
  }
  ScoredItem out;
  out.score = score_item(truth, samples);
  out.training = training_material(truth, corpus.info().seed, options.threads);
  out.generated = judged_material(truth, samples);
  out.truth = judged_material(truth, truth.takes);
  return out;
}

void judge_conditions(std::vector<ScoredItem>& items) {
  ConditionMaterial training;
  for (const ScoredItem& item : items) training.append(item.training);
  const CentroidClassifier emotion(training.emotion), level(training.level), style(training.style);
  for (ScoredItem& item : items) {
    item.score.emotion = {judge(emotion, item.generated.emotion), judge(emotion, item.truth.emotion)};
    item.score.level = {judge(level, item.generated.level), judge(level, item.truth.level)};
    item.score.style = {judge(style, item.generated.style), judge(style, item.truth.style)};
  }
}

}  // namespace

SyntheticItemScore& SyntheticItemScore::operator+=(const SyntheticItemScore& other) {
  lips_neutral += other.lips_neutral;
  lips += other.lips;
  for (std::size_t r = 0; r < kNumFaceRegions; ++r) {
    diversity[r] += other.diversity[r];
    smoothness[r] += other.smoothness[r];
    accuracy[r] += other.accuracy[r];
  }
  calibration += other.calibration;
  blinks += other.blinks;
  brows += other.brows;
  nods += other.nods;
  gaze += other.gaze;
  rest += other.rest;
  closures += other.closures;
  emotion += other.emotion;
  level += other.level;
  style += other.style;
  return *this;
}

Result<SyntheticReport> evaluate_synthetic(const std::filesystem::path& corpus, const SyntheticSystem& system,
                                           const SyntheticOptions& options, Progress& progress) {
  contract(options.samples >= 2 && options.true_takes >= options.samples && options.threads >= 1,
           "evaluate_synthetic: at least 2 samples, as many true takes and 1 thread are needed");
  MIEN_TRY(const CorpusReader reader, CorpusReader::open(corpus));
  if (reader.info().generator_hash != generator_hash())
    return Error{
        Errc::incompatible, "corpus '" + corpus.string() + "'",
        "it was made by another version of the curve generator, so its true takes cannot be drawn again",
        "Build it again"};
  const auto chosen = choose_items(reader.items(), options);
  if (chosen.empty())
    return Error{Errc::input, "corpus '" + corpus.string() + "'", "it has no item of these splits", ""};
  progress.stage("evaluating on '" + corpus.filename().string() + "'",
                 static_cast<std::int64_t>(chosen.size()));
  std::vector<ScoredItem> scored;
  for (const CorpusItem* item : chosen) {
    if (progress.cancelled()) return Error{Errc::cancelled, "evaluation", "interrupted", ""};
    auto result = run_item(reader, *item, system, options);
    if (!result) return within(result.error(), "item '" + item->id + "'");
    scored.push_back(std::move(result).value());
    progress.update(static_cast<std::int64_t>(scored.size()));
  }
  judge_conditions(scored);
  SyntheticReport report{options, {}};
  for (ScoredItem& item : scored) report.items.push_back(std::move(item.score));
  return report;
}

}  // namespace mien
