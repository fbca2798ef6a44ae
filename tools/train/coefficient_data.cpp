#include "coefficient_data.h"

#include <algorithm>
#include <cmath>

#include "mien/audio/load_audio.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"

namespace mien::train {
namespace {

Result<std::vector<float>> divisible(std::vector<float> deviation, const std::string& place,
                                     const std::string& fix) {
  for (std::size_t k = 0; k < deviation.size(); ++k)
    if (!(deviation[k] > 0) || !std::isfinite(deviation[k]))
      return Error{Errc::incompatible, "the deviation of '" + arkit_order(ArkitOrder::said)[k] + "'",
                   "is " + shortest(deviation[k]) + " in " + place, fix};
  return deviation;
}

}  // namespace

Result<CoefficientData> read_coefficient_data(
    const std::filesystem::path& folder,
    const std::function<std::filesystem::path(const CoefficientFile&)>& sound_of, ConsoleProgress& progress) {
  const auto files = list_coefficients(folder);
  if (!files) return files.error();
  for (const auto& warning : files.warnings) progress.warn(warning);
  const bool knows_speakers = std::ranges::any_of(
      *files, [](const CoefficientFile& f) { return coefficient_split(f.person) == "train"; });
  CoefficientData data;
  progress.stage("sequences", static_cast<std::int64_t>(files->size()));
  std::int64_t done = 0;
  std::vector<std::string> absent;  // sound
  for (const auto& file : *files) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    progress.update(++done);
    const auto split = knows_speakers ? coefficient_split(file.person) : "train";
    if (split != "train" && split != "val") continue;
    CoefficientSequence sequence{file.path.string(), {}, {}};
    if (sound_of) {
      const auto sound = sound_of(file);
      if (!std::filesystem::exists(sound)) {
        absent.push_back(sound.string());
        continue;
      }
      MIEN_TRY(AudioClip clip, load_audio(sound));
      if (clip.samples.empty()) continue;
      sequence.waveform = std::move(clip.samples);
    }
    MIEN_TRY(Motion motion, read_coefficients(file.path));
    if (motion.num_frames() == 0) continue;
    sequence.coefficients = std::move(motion.values);
    (split == "train" ? data.train : data.valid).push_back(std::move(sequence));
  }
  if (!absent.empty())
    progress.warn(std::to_string(absent.size()) + " sequences have no sound and are left out, for example '" +
                  absent.front() + "'");
  if (data.train.empty())
    return Error{
        Errc::incompatible, "'" + folder.string() + "'",
        sound_of ? "has no sequence with sound to learn from" : "has no frame to learn from",
        sound_of ? "Expected is <person>/sentenceNN.wav beside the coefficients or in [run] sound" : ""};
  return data;
}

Result<std::vector<float>> read_deviation(const std::filesystem::path& path) {
  const std::string place = "'" + path.string() + "'";
  MIEN_TRY(Motion row, read_coefficients(path));
  if (row.num_frames() != 1)
    return Error{Errc::incompatible, place,
                 "has " + std::to_string(row.num_frames()) + " rows of deviations, not one", ""};
  return divisible(std::move(row.values), place, "Name another file, or none, in [run] deviation");
}

Result<std::vector<float>> measure_deviation(const std::vector<CoefficientSequence>& sequences) {
  const std::size_t width = arkit_order(ArkitOrder::said).size();
  std::vector<double> sum(width), squares(width);
  double count = 0;
  for (const auto& s : sequences)
    for (std::size_t i = 0; i < s.coefficients.size(); ++i) {
      const auto value = static_cast<double>(s.coefficients[i]);
      sum[i % width] += value, squares[i % width] += value * value;
      count += i % width == 0 ? 1 : 0;
    }
  std::vector<float> deviation(width);
  for (std::size_t k = 0; k < width; ++k) {
    const double mean = sum[k] / count;
    deviation[k] = static_cast<float>(std::sqrt(std::max(0.0, squares[k] / count - mean * mean)));
  }
  return divisible(
      std::move(deviation), "the training sequences",
      "Name a file of deviations in [run] deviation, or set [training] divide_by_deviation = false");
}

}  // namespace mien::train
