#include "corpus_coefficients.h"

#include "mien/core/arkit.h"
#include "mien/train/corpus_data.h"

namespace mien::train {
namespace {

/// Columns of the 32 among ARKit's 52.
std::vector<std::size_t> said_columns() {
  std::vector<std::size_t> columns;
  for (const auto& name : arkit_order(ArkitOrder::said)) columns.push_back(arkit_index(name));
  return columns;
}

}  // namespace

Result<CoefficientData> read_corpus_coefficients(const std::filesystem::path& folder,
                                                 const CorpusFields& corpus, bool hears,
                                                 ConsoleProgress& progress) {
  CorpusDataOptions wanted;
  wanted.fps = kCoefficientFps;
  wanted.num_takes = corpus.num_takes;
  wanted.style = CorpusStyle::none;
  if (hears) {  // windows of the sound are normalised, not the whole
    wanted.sound.encoder.emplace();
    wanted.sound.encoder->do_normalize = false;
  }
  MIEN_TRY(const CorpusData found, corpus_data(folder, corpus.validation, wanted));
  const auto columns = said_columns();
  progress.stage("performances",
                 static_cast<std::int64_t>(found.sequences.num_train + found.sequences.num_valid));
  std::int64_t done = 0;
  const auto load = [&](FaceSequences::Split split, std::size_t index) -> Result<CoefficientSequence> {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    progress.update(++done);
    MIEN_TRY(FaceSequence face, found.sequences.load(split, index));
    CoefficientSequence sequence{face.name, {}, std::move(face.waveform)};
    for (std::size_t frame = 0; frame + kNumArkit <= face.motion.size(); frame += kNumArkit)
      for (const std::size_t column : columns) sequence.coefficients.push_back(face.motion[frame + column]);
    return sequence;
  };
  CoefficientData data;
  for (std::size_t i = 0; i < found.sequences.num_train; ++i) {
    MIEN_TRY(data.train.emplace_back(), load(FaceSequences::Split::train, i));
  }
  for (std::size_t i = 0; i < found.sequences.num_valid; ++i) {
    MIEN_TRY(data.valid.emplace_back(), load(FaceSequences::Split::valid, i));
  }
  return data;
}

}  // namespace mien::train
