// mien evaluate coefficients: SAiD's measures of generated blendshape coefficients.
#include "evaluate_coefficients.h"

#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "metric_row.h"
#include "mien/audio/load_audio.h"
#include "mien/base/parallel.h"
#include "mien/datasets/coefficient_folder.h"
#include "mien/metrics/aperture.h"
#include "mien/metrics/beat_consistency.h"
#include "mien/metrics/coefficient_comparison.h"
#include "mien/metrics/lip_lag.h"
#include "mien/metrics/loudness.h"
#include "mien/metrics/report.h"
#include "mien/metrics/speech_onsets.h"
#include "mien/metrics/statistics.h"
#include "mien/models/said/vae.h"
#include "options.h"
#include "printing.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

struct CoefficientArguments {
  std::string generated, truth, codec, speech, split = "all";
  int repeats = 10;
  std::uint64_t seed = 0;
  TableForm form;
  int threads = hardware_threads();
};

using Key = std::pair<std::string, int>;

/// What speech alone tells, by person and sentence.
struct Speech {
  std::vector<double> onsets, level_db;
};

Tensor as_tensor(const Motion& motion) {
  return Tensor({motion.num_frames(), motion.num_channels()}, motion.values);
}

FeatureTable as_table(const Motion& motion) {
  return {motion.num_channels(), {motion.values.begin(), motion.values.end()}};
}

bool wanted(const CoefficientArguments& a, const CoefficientFile& file) {
  return a.split == "all" || coefficient_split(file.person) == a.split;
}

Result<std::vector<CoefficientFile>> chosen_files(const std::string& folder, const CoefficientArguments& a,
                                                  ConsoleProgress& progress) {
  auto files = list_coefficients(folder);
  if (!files) return files.error();
  for (const auto& warning : files.warnings) progress.warn(warning);
  std::erase_if(*files, [&](const CoefficientFile& f) { return !wanted(a, f); });
  if (files->empty())
    return Error{Errc::input, "'" + folder + "'", "holds no sentence of the split '" + a.split + "'",
                 "Persons are folders with VOCASET's names; --split all takes whatever is there"};
  return files;
}

Result<Speech> read_speech(const CoefficientArguments& a, const Key& key) {
  const std::string number = std::to_string(key.second);
  const fs::path path = fs::path(a.speech) / key.first /
                        ("sentence" + std::string(number.size() < 2 ? "0" : "") + number + ".wav");
  MIEN_TRY(const AudioClip clip, load_audio(path));
  return Speech{speech_onsets(clip.samples), speech_level_db(clip.samples)};
}

/// Figures that need the speech.
struct SpeechFigures {
  std::vector<BeatSequence> beats;
  std::vector<double> lags, confidences;

  Status add(const Speech& speech, const Motion& motion) {
    beats.push_back({speech.onsets, as_table(motion)});
    MIEN_TRY(const Aperture aperture, curve_aperture(motion, ApertureVariant::curves));
    const LipLag lag = lip_lag(aperture.values, speech.level_db);
    if (!std::isfinite(lag.lag_ms)) return Done{};
    lags.push_back(lag.lag_ms);
    confidences.push_back(lag.confidence);
    return Done{};
  }
  void report(MetricTable& table) const {
    table.rows.push_back(metric_row(
        "beat consistency", beat_consistency(beats),
        "mean over sequences of the mean over the speech's onsets of exp(-d^2 / (2 * 0.1^2)), d seconds to "
        "the "
        "nearest instant at which the motion slows down (SAiD's program; onsets by Mien's own detector after "
        "librosa's documentation)"));
    table.rows.push_back(
        metric_row("lip lag", mean(lags),
                   "mean over sequences of the lag of the largest correlation between lip opening (jawOpen - "
                   "mouthClose) and loudness within half a second, positive = lips late (Mien's own, not "
                   "SyncNet's offset)",
                   "ms"));
    table.rows.push_back(
        metric_row("lip lag confidence", mean(confidences),
                   "mean over sequences of that correlation less the median over all lags (Mien's own, not "
                   "SyncNet's confidence)"));
    if (lags.size() < beats.size())
      table.notes.push_back("no lag: " + std::to_string(beats.size() - lags.size()) +
                            " sequences are shorter than two seconds, silent or still");
  }
};

void add_distance_rows(const MotionDistances& d, const CoefficientArguments& a, MetricTable& table) {
  const std::string repeats = std::to_string(a.repeats);
  table.rows.push_back(
      metric_row("FD", d.fd,
                 "|m1 - m2|^2 + tr S1 + tr S2 - 2 tr (S1 S2)^(1/2), means and covariances (divisor n - 1) of "
                 "the codec's codes of all windows, generated and true (SAiD's program)"));
  table.rows.push_back(
      metric_row("WInD", d.wind.mean,
                 "cheapest transport between two mixtures of 5 Gaussians at their squared Wasserstein-2 "
                 "distances, mean over " +
                     repeats + " fits from different starts (SAiD's program)"));
  table.rows.push_back(
      metric_row("WInD deviation", d.wind.deviation, "sample standard deviation over the same fits"));
  table.rows.push_back(
      metric_row("multimodality", d.multimodality,
                 "mean Euclidean distance of the codes of the i-th of the first and the i-th of the second "
                 "half of the repetitions of a window, repetitions in the order of their names (SAiD's "
                 "program, in the order of the disk; the paper pairs at random)"));
}

Status evaluate_coefficients(const CoefficientArguments& a, ConsoleProgress& progress) {
  MIEN_TRY(const said::Vae<Tensor> codec, said::load_vae(a.codec));
  const said::VaeSizes& sizes = codec.encoder.sizes;
  MIEN_TRY(const auto truths, chosen_files(a.truth, a, progress));
  MIEN_TRY(const auto generated, chosen_files(a.generated, a, progress));
  const auto interrupted = [&] { return Error{Errc::cancelled, "", "interrupted", ""}; };
  const auto features = [&](const Motion& motion, std::int64_t num_windows) -> FeatureTable {
    const Tensor codes = said::window_features(codec, as_tensor(motion), num_windows);
    return {codes.width(), {codes.values().begin(), codes.values().end()}};
  };
  const auto read = [&](const CoefficientFile& file) -> Result<Motion> {
    MIEN_TRY(Motion motion, read_coefficients(file.path));
    if (motion.num_channels() != sizes.channels)
      return Error{Errc::incompatible, "codec '" + a.codec + "'",
                   "takes " + std::to_string(sizes.channels) + " coefficients, sequences have " +
                       std::to_string(motion.num_channels()),
                   ""};
    return motion;
  };

  CoefficientComparison comparison(sizes.window, features);
  progress.stage("truth", static_cast<std::int64_t>(truths.size()));
  std::int64_t done = 0;
  std::set<Key> seen;
  for (const auto& file : truths) {
    if (progress.cancelled()) return interrupted();
    if (!seen.insert({file.person, file.sentence}).second)
      return Error{Errc::input, "'" + file.path.string() + "'", "is a second truth of its sentence", ""};
    MIEN_TRY(const Motion motion, read(file));
    comparison.add_truth(file.person, file.sentence, motion);
    progress.update(++done);
  }

  SpeechFigures speech_figures;
  std::map<Key, Speech> speech;
  std::set<Key> without_truth;
  std::int64_t num_used = 0;
  progress.stage("generated", static_cast<std::int64_t>(generated.size()));
  done = 0;
  for (const auto& file : generated) {
    if (progress.cancelled()) return interrupted();
    const Key key{file.person, file.sentence};
    if (!seen.contains(key)) {
      without_truth.insert(key);
    } else {
      MIEN_TRY(const Motion motion, read(file));
      comparison.add_generated(file.person, file.sentence, motion);
      ++num_used;
      if (!a.speech.empty()) {
        if (!speech.contains(key)) {
          speech.clear();  // files come sentence by sentence
          MIEN_TRY(speech[key], read_speech(a, key));
        }
        MIEN_TRY([[maybe_unused]] const auto added, speech_figures.add(speech[key], motion));
      }
    }
    progress.update(++done);
  }
  if (!without_truth.empty())
    progress.warn(std::to_string(without_truth.size()) +
                  " generated sentences have no truth and are left out, the first is " +
                  without_truth.begin()->first + " sentence " +
                  std::to_string(without_truth.begin()->second));

  progress.stage("mixtures", 0);
  WindOptions options;
  options.num_repeats = a.repeats, options.mixture.seed = a.seed, options.num_threads = a.threads;
  const MotionDistances distances = comparison.distances(options);
  progress.finish_line();
  MetricTable table{
      "Coefficients: " + std::to_string(num_used) + " generated and " + std::to_string(truths.size()) +
          " true sequences, " + std::to_string(distances.num_generated) + " and " +
          std::to_string(distances.num_true) + " windows of " + std::to_string(sizes.window) + " frames",
      {"value"},
      {},
      {}};
  add_distance_rows(distances, a, table);
  if (!a.speech.empty()) speech_figures.report(table);
  table.notes.push_back(
      "Codes are those of the codec '" + fs::path(a.codec).filename().string() +
      "'; those of another codec cannot be compared. Seed of the mixtures: " + std::to_string(a.seed));
  return print(table, a.form, true);
}

}  // namespace

void add_coefficient_evaluation(CLI::App& evaluate, Chosen& chosen) {
  auto* command = evaluate.add_subcommand(
      "coefficients",
      "FD, WInD, multimodality, beat consistency and lip lag of blendshape coefficients (SAiD)");
  auto a = std::make_shared<CoefficientArguments>();
  command->add_option("GENERATED", a->generated, "Folder of <person>/sentenceNN-<repetition>.csv")
      ->required();
  command->add_option("TRUTH", a->truth, "Folder of <person>/sentenceNN.csv")->required();
  command->add_option("--codec", a->codec, "SAiD's motion codec: mien import vae.pth -o said_vae.safetensors")
      ->required();
  command->add_option(
      "--speech", a->speech,
      "Folder of <person>/sentenceNN.wav, for beat consistency and lip lag. Default: without them");
  command
      ->add_option("--split", a->split, "Whose sentences: all, or VOCASET's speakers of train, val or test")
      ->check(CLI::IsMember({"all", "train", "val", "test"}))
      ->capture_default_str();
  command->add_option("--repeats", a->repeats, "Fits of the mixtures of WInD, 1 to 1000")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--seed", a->seed, "Seed of those fits")->capture_default_str();
  add_table_options(*command, a->form, chosen);
  add_threads_option(*command, a->threads);
  add_footer(*command,
             "  mien evaluate coefficients generated BlendVOCA/coefficients --codec said_vae.safetensors "
             "--split test\n"
             "  mien evaluate coefficients generated truth --codec said_vae.safetensors --speech audio\n");
  command->callback([a, &chosen] {
    a->form.json = chosen.json;
    chosen.work = [a](ConsoleProgress& progress) { return evaluate_coefficients(*a, progress); };
  });
}

}  // namespace mien
