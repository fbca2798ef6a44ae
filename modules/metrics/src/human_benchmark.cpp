#include "mien/metrics/human_benchmark.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "mien/base/contract.h"
#include "mien/base/number_text.h"
#include "mien/metrics/baselines.h"
#include "mien/metrics/loudness.h"

namespace mien {
namespace {

constexpr double kMaxMissingSeconds = 0.1;  // a frame or two of rounding is no fault; a cut motion is

HumanClipScore& operator+=(HumanClipScore& a, const HumanClipScore& b) {
  a.closures += b.closures;
  a.strict += b.strict;
  a.rest += b.rest;
  a.jaw.insert(a.jaw.end(), b.jaw.begin(), b.jaw.end());
  return a;
}

// The take at 60 frames/s, cut to the recording.
Result<Motion> prepare_take(const Motion& take, double seconds) {
  MIEN_TRY(Motion motion, at_metric_rate(take));
  const std::int64_t expected = num_motion_frames(seconds, kMetricFps);
  if (static_cast<double>(expected - motion.num_frames()) > kMaxMissingSeconds * kMetricFps)
    return Error{
        Errc::incompatible, "motion",
        "it covers " + fixed(motion.seconds(), 2) + " s of a recording of " + fixed(seconds, 2) + " s", ""};
  if (motion.num_frames() > expected)
    motion.values.resize(static_cast<std::size_t>(expected) * motion.channels.size());
  return motion;
}

Result<HumanClipScore> score_take(const BenchmarkClip& clip, const SpeechLabels& labels, const Motion& take,
                                  ApertureVariant variant, std::span<const double> level_db) {
  MIEN_TRY(const Motion motion, prepare_take(take, labels.seconds()));
  MIEN_TRY(const Aperture aperture, curve_aperture(motion, variant));
  MIEN_TRY(const std::vector<double> jaw, channel_series(motion, "jawOpen"));
  return score_human_clip(clip, labels, aperture, jaw, level_db, &motion);
}

Result<std::vector<BenchmarkClip>> select(std::vector<BenchmarkClip> clips,
                                          const std::vector<std::string>& only) {
  if (only.empty()) return clips;
  std::vector<BenchmarkClip> out;
  for (const std::string& id : only) {
    const auto found = std::find_if(clips.begin(), clips.end(), [&](const auto& c) { return c.id == id; });
    if (found == clips.end())
      return Error{Errc::usage, "clip '" + id + "'", "the benchmark has no such recording", ""};
    out.push_back(*found);
  }
  return out;
}

std::vector<Interval> intervals(std::span<const HumanClipScore> a, std::span<const HumanClipScore> b,
                                int num_draws, std::uint64_t seed) {
  std::vector<std::string> speakers;
  for (const HumanClipScore& clip : a) speakers.push_back(clip.speaker);
  const auto fields = human_figure_fields();
  std::vector<std::vector<double>> values(fields.size());
  for (const auto& draw : speaker_draws(speakers, num_draws, seed)) {
    const HumanFigures of_a = pool_human(a, draw);
    const HumanFigures of_b = b.empty() ? HumanFigures{} : pool_human(b, draw);
    for (std::size_t f = 0; f < fields.size(); ++f)
      values[f].push_back(of_a.*fields[f].value - of_b.*fields[f].value);
  }
  std::vector<Interval> out;
  for (auto& v : values) out.push_back(interval_of(std::move(v)));
  return out;
}

}  // namespace

HumanClipScore score_human_clip(const BenchmarkClip& clip, const SpeechLabels& labels,
                                const Aperture& aperture, std::span<const double> jaw,
                                std::span<const double> level_db, const Motion* mouth) {
  HumanClipScore score{clip.id, clip.speaker, {}, {}, {}, {}};
  score.closures = score_closures(aperture, labels, kClosureToleranceSeconds);
  score.strict = score_closures(aperture, labels, kStrictClosureToleranceSeconds);
  score.rest = score_rest(aperture, labels, mouth);
  if (!jaw.empty() && !level_db.empty()) score.jaw.push_back(jaw_energy(jaw, level_db, labels));
  return score;
}

std::span<const HumanFigureField> human_figure_fields() {
  using F = HumanFigures;
  static constexpr HumanFigureField kFields[] = {
      {"targets", "events", "lip closures (p, b, m or a merged group) that are not doubtful, times takes",
       &F::targets},
      {"hit rate", "", "targets with a closed frame within 50 ms and a mouth open nearby (200 ms) / targets",
       &F::hit_rate},
      {"precision", "",
       "closed runs outside silence that touch a target / those plus false ones; runs at doubtful "
       "closures, f and v ignored; one more false per 300 ms of run",
       &F::precision},
      {"closure F1", "", "2PH / (P + H), tolerance 50 ms", &F::f1},
      {"sealed", "", "hits whose smallest aperture in the window is <= 0 in that single take / hits",
       &F::sealed_share},
      {"timing bias", "ms",
       "median of centre of the nearest closed run - centre of the closure; positive = late",
       &F::timing_bias_ms},
      {"timing MAD", "ms", "median absolute deviation of the same", &F::timing_mad_ms},
      {"timed hits", "events", "hits without edge, cluster or merged flag: the base of the timing figures",
       &F::timed_hits},
      {"depth", "R", "median over hits of the smallest aperture in the window / R", &F::depth},
      {"strict hit rate", "", "hit rate with tolerance 20 ms", &F::strict_hit_rate},
      {"strict precision", "", "precision with tolerance 20 ms", &F::strict_precision},
      {"strict closure F1", "", "closure F1 with tolerance 20 ms", &F::strict_f1},
      {"pause motion ratio", "",
       "mean speed of the aperture in pauses (150 ms after start to 100 ms before end) / in "
       "phones",
       &F::pause_motion_ratio},
      {"pause motion ratio, mouth", "",
       "the same with the mean over the 27 jaw and mouth curves in place of the aperture",
       &F::mouth_pause_motion_ratio},
      {"pause motion ratio, curves", "",
       "the same with the mean over the 27 curves of each curve's own speed", &F::curve_pause_motion_ratio},
      {"mean pause aperture", "R", "mean aperture in pauses / R", &F::mean_pause_aperture},
      {"last frame closed", "", "takes whose last frame has aperture <= theta / takes",
       &F::closed_at_end_share},
      {"jaw-energy correlation", "",
       "Pearson r of smoothed level and jawOpen in and near phones, Fisher z weighted by "
       "frames; plausible between 0.5 and 0.85",
       &F::jaw_energy_r},
      {"jaw-energy lag", "ms", "lag within +-100 ms of the largest pooled r; positive = the jaw is late",
       &F::jaw_energy_lag_ms},
  };
  return kFields;
}

HumanFigures pool_human(std::span<const HumanClipScore> clips, std::span<const std::size_t> indices) {
  ClosureScore closures, strict;
  RestScore rest;
  std::vector<JawEnergy> jaw;
  for (const std::size_t i : indices) {
    closures += clips[i].closures;
    strict += clips[i].strict;
    rest += clips[i].rest;
    jaw.insert(jaw.end(), clips[i].jaw.begin(), clips[i].jaw.end());
  }
  const PooledJawEnergy energy = pool_jaw_energy(jaw);
  HumanFigures f;
  f.targets = static_cast<double>(closures.targets);
  f.hit_rate = closures.hit_rate();
  f.precision = closures.precision();
  f.f1 = closures.f1();
  f.sealed_share = closures.sealed_share();
  f.timing_bias_ms = closures.timing_bias_ms();
  f.timing_mad_ms = closures.timing_mad_ms();
  f.timed_hits = static_cast<double>(closures.timing_errors_ms.size());
  f.depth = closures.depth();
  f.strict_hit_rate = strict.hit_rate();
  f.strict_precision = strict.precision();
  f.strict_f1 = strict.f1();
  f.pause_motion_ratio = rest.pause_motion_ratio();
  f.mouth_pause_motion_ratio = rest.mouth_pause_motion_ratio();
  f.curve_pause_motion_ratio = rest.curve_pause_motion_ratio();
  f.mean_pause_aperture = rest.mean_pause_aperture();
  f.closed_at_end_share = rest.closed_at_end_share();
  f.jaw_energy_r = energy.r;
  f.jaw_energy_lag_ms = energy.lag_ms;
  return f;
}

HumanFigures pool_human(std::span<const HumanClipScore> clips) {
  std::vector<std::size_t> all(clips.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return pool_human(clips, all);
}

std::vector<Interval> human_intervals(std::span<const HumanClipScore> clips, int num_draws,
                                      std::uint64_t seed) {
  return intervals(clips, {}, num_draws, seed);
}

std::vector<Interval> human_difference_intervals(std::span<const HumanClipScore> a,
                                                 std::span<const HumanClipScore> b, int num_draws,
                                                 std::uint64_t seed) {
  contract(a.size() == b.size(), "human_difference_intervals: both systems need the same recordings");
  for (std::size_t i = 0; i < a.size(); ++i)
    contract(a[i].id == b[i].id,
             "human_difference_intervals: both systems need the same recordings in order");
  return intervals(a, b, num_draws, seed);
}

std::vector<std::size_t> HumanReport::group(SpeechGroup group) const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < clips.size(); ++i)
    if (belongs_to(clips[i], group)) out.push_back(i);
  return out;
}

Result<HumanReport> evaluate_human(const std::filesystem::path& folder, const HumanEvaluation& evaluation,
                                   Progress& progress) {
  contract(evaluation.load && evaluation.generate, "evaluate_human: load and generate must be given");
  contract(evaluation.variant != ApertureVariant::mesh,
           "evaluate_human: curves only; score meshes clip by clip");
  MIEN_TRY(const std::vector<BenchmarkClip> all, read_benchmark(folder));
  std::map<std::string, std::filesystem::path> audio_of;
  for (const BenchmarkClip& clip : all) audio_of[clip.id] = clip.audio;
  HumanReport report;
  report.variant = evaluation.variant;
  MIEN_TRY(report.clips, select(all, evaluation.only));
  progress.stage("human speech benchmark", static_cast<std::int64_t>(report.clips.size()));
  for (const BenchmarkClip& clip : report.clips) {
    if (progress.cancelled()) return Error{Errc::cancelled, "evaluation", "interrupted", ""};
    const auto of_clip = [&](const Error& error) { return within(error, "clip '" + clip.id + "'"); };
    const auto labels = read_labels(clip);
    if (!labels) return of_clip(labels.error());
    const auto audio = evaluation.load(clip.audio);
    if (!audio) return of_clip(audio.error());
    contract(audio->sample_rate_hz == kModelSampleRateHz, "evaluate_human: the loader must give 16 kHz");
    std::vector<double> level = speech_level_db(audio->samples);
    if (clip.clean_id != clip.id) {
      const auto clean = evaluation.load(audio_of.at(clip.clean_id));
      if (!clean) return of_clip(clean.error());
      level = speech_level_db(clean->samples);
    }
    const auto takes = evaluation.generate(clip.id, audio->samples);
    if (!takes) return of_clip(takes.error());
    if (takes->empty()) return of_clip({Errc::incompatible, "motion", "the system gave no take", ""});
    HumanClipScore sum{clip.id, clip.speaker, {}, {}, {}, {}};
    for (const Motion& take : *takes) {
      const auto score = score_take(clip, *labels, take, evaluation.variant, level);
      if (!score) return of_clip(score.error());
      sum += *score;
    }
    report.motion_fps = takes->front().fps;
    report.takes = std::max(report.takes, static_cast<std::int64_t>(takes->size()));
    report.scores.push_back(std::move(sum));
    report.loudness.push_back(score_human_clip(
        clip, *labels, steep_loudness_aperture(loudness(speech_level_db(audio->samples))), {}, {}, nullptr));
    progress.update(static_cast<std::int64_t>(report.scores.size()));
  }
  return report;
}

}  // namespace mien
