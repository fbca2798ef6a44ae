#include "benchmark_performer.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mien/base/parallel.h"
#include "mien/core/arkit.h"
#include "mien/corpus/take.h"
#include "mien/metrics/aperture.h"
#include "mien/models/animate.h"

namespace mien {
namespace {

// One performance of the model that the plan directs.
Result<Motion> performance(const AnimatePlan& plan, const Performer& performer, const AudioClip& clip,
                           std::uint64_t seed) {
  Progress unseen;
  if (const auto* model = std::get_if<DefaultModel>(&performer)) {
    PerformOptions options = plan.options;
    options.seed = seed;
    return animate(*model, clip, options, unseen);
  }
  constexpr int kTakes = 1, kThreads = 1;
  if (const auto* model = std::get_if<FaceModel>(&performer)) {
    FaceOptions options = plan.face;
    options.seed = seed;
    MIEN_TRY(auto takes, animate(*model, clip, options, kTakes, kThreads, unseen));
    return std::move(takes.front());
  }
  SaidOptions options = plan.said;
  options.seed = seed;
  MIEN_TRY(auto takes, animate(std::get<SaidModel>(performer), clip, options, kTakes, kThreads, unseen));
  return std::move(takes.front());
}

// The channels of the benchmarks at their rate; the last frame is held to the end of the sound.
Motion as_measured(const Motion& motion, const AudioClip& clip) {
  const Motion even = resample(motion, kMetricFps);
  Motion out{MotionSpace::arkit, arkit_and_head_channels(), kMetricFps, {}};
  std::vector<std::optional<std::int64_t>> from;
  for (const auto& channel : out.channels) from.push_back(even.find(channel));
  const auto sound = static_cast<double>(clip.samples.size()) / static_cast<double>(clip.sample_rate_hz);
  const auto whole = static_cast<std::int64_t>(std::floor(sound * kMetricFps));
  const std::int64_t own = even.num_frames(), wanted = own == 0 ? 0 : std::max(own, whole);
  for (std::int64_t n = 0; n < wanted; ++n)
    for (const auto& channel : from)
      out.values.push_back(channel ? even.frame(std::min(n, own - 1))[static_cast<std::size_t>(*channel)]
                                   : 0.0f);
  return out;
}

// The words for an item's emotion in a published model: "happy:2" of one with levels, else the first or last.
std::string emotion_word(const ModelFile& model, const CorpusItem& item) {
  const auto& names = model.emotions;
  if (names.empty()) return "";
  if (model.intensities.empty()) return item.emotion == Emotion::neutral ? names.front() : names.back();
  const std::string name(emotion_names()[static_cast<std::size_t>(item.emotion)]);
  if (std::ranges::find(names, name) == names.end()) return names.front();
  return item.emotion == Emotion::neutral ? name : name + ":" + std::to_string(item.level);
}

}  // namespace

Result<BenchmarkPerformer> BenchmarkPerformer::load(const AnimateArguments& arguments) {
  AnimatePlan plan;
  MIEN_TRY(ModelFile model, plan_performer(arguments, plan));
  if (plan.system != AnimatePlan::System::standard && model.output.space != "arkit")
    return Error{Errc::incompatible, "model '" + arguments.model + "'",
                 "moves " + model.output.space + ", not the ARKit coefficients that are measured here",
                 "Measure it with: mien evaluate vertices, controls or takes"};
  MIEN_TRY(Performer performer, load_performer(arguments, plan));
  return BenchmarkPerformer(arguments, std::move(plan), std::move(model), std::move(performer));
}

Result<std::vector<Motion>> BenchmarkPerformer::perform(const AnimatePlan& plan, const AudioClip& clip,
                                                        std::span<const std::uint64_t> seeds) const {
  std::vector<std::optional<Result<Motion>>> takes(seeds.size());
  parallel_for(arguments_.threads, static_cast<std::int64_t>(seeds.size()), [&](std::int64_t k) {
    const auto place = static_cast<std::size_t>(k);
    takes[place].emplace(performance(plan, *performer_, clip, seeds[place]));
  });
  std::vector<Motion> motions;
  for (auto& take : takes) {
    if (!*take) return take->error();
    motions.push_back(as_measured(**take, clip));
  }
  return motions;
}

Result<std::vector<Motion>> BenchmarkPerformer::perform(const AudioClip& clip,
                                                        std::span<const std::uint64_t> seeds) const {
  return perform(plan_, clip, seeds);
}

Result<AnimatePlan> BenchmarkPerformer::directed(const CorpusItem& item) const {
  AnimatePlan plan = plan_;
  if (plan.system == AnimatePlan::System::standard) {
    DirectionKey key;
    if (item.emotion != Emotion::neutral)
      key.intensities[static_cast<std::size_t>(item.emotion)] = item.intensity();
    if (const auto style = parse_style(item.speaker)) key.style = *style;  // else one never seen in training
    plan.options.direction = Direction({key});
    return plan;
  }
  AnimateArguments own = arguments_;
  own.words.emotion = emotion_word(model_, item);
  if (std::ranges::find(model_.subjects, item.speaker) != model_.subjects.end())
    own.words.style = item.speaker;  // else the first
  MIEN_TRY([[maybe_unused]] const auto model, plan_performer(own, plan));
  return plan;
}

Result<std::vector<Motion>> BenchmarkPerformer::perform(const CorpusItem& item, const AudioClip& clip,
                                                        std::span<const std::uint64_t> seeds) const {
  MIEN_TRY(const AnimatePlan plan, directed(item));
  return perform(plan, clip, seeds);
}

}  // namespace mien
