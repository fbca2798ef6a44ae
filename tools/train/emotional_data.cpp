#include "emotional_data.h"

#include "mien/corpus/corpus_reader.h"
#include "mien/models/probtalk3d/conventions.h"
#include "mien/train/corpus_data.h"
#include "mien/train/face_data.h"

namespace mien::train {
namespace {

constexpr double kFps = 25;

Result<EmotionalData> open_corpus(const std::filesystem::path& folder, const EmotionalDataOptions& options) {
  MIEN_TRY(CorpusData corpus, corpus_data(folder, options.corpus.validation,
                                          {options.sound, kFps, options.corpus.num_takes, options.subjects,
                                           options.needs_neutral}));
  EmotionalData data;
  data.sequences = std::move(corpus.sequences);
  data.subjects = std::move(corpus.subjects);
  data.output = std::move(corpus.output);
  data.jaw = probtalk3d::arkit_jaw();
  data.description = std::move(corpus.description);
  data.licence = std::move(corpus.licence);
  return data;
}

Result<EmotionalData> open_mead(const std::filesystem::path& folder, const EmotionalDataOptions& options,
                                ConsoleProgress& progress) {
  MIEN_TRY(Dataset opened, open_dataset(folder, options.kind));
  const auto dataset = std::make_shared<const Dataset>(std::move(opened));
  if (!dataset->unpaired_motion.empty())
    progress.warn(std::to_string(dataset->unpaired_motion.size()) +
                  " motions have no sound and are left out, for example '" +
                  dataset->unpaired_motion.front() + "'");
  EmotionalData data;
  data.subjects = options.subjects.empty() ? dataset->layout->train_subjects : options.subjects;
  const bool is_mesh = dataset->layout->space == MotionSpace::vertices;
  if (is_mesh) {
    MIEN_TRY(const std::int64_t width, loaded_width(*dataset));
    data.output = {.space = "vertices",
                   .channels = width,
                   .fps = dataset->layout->fps,
                   .topology = topology_of(width / 3).name};
    data.templates = dataset->templates;
  } else {
    const std::int64_t width = options.num_expression + mien::probtalk3d::kNumJaw;
    data.output = {.space = "flame", .channels = width, .fps = dataset->layout->fps, .topology = "flame"};
    data.scaler = mien::probtalk3d::published_scaler(width);
    data.jaw = probtalk3d::flame_jaw(width);
  }
  FaceDataOptions wanted{options.sound, data.subjects,          /*has_emotions=*/true,
                         is_mesh,       options.num_expression, data.scaler};
  // Stage 1 validates subjects that it does not learn from, and has no styles.
  if (options.kind == DatasetKind::mead_prior) wanted.subjects = options.subjects;
  MIEN_TRY(data.sequences, face_sequences(dataset, std::move(wanted)));
  data.description = "{\"layout\": \"" + std::string(dataset->layout->name) + "\"}";
  data.licence =
      "that of the data set '" + std::string(dataset->layout->name) + "' and of the speech encoder";
  return data;
}

}  // namespace

void EmotionalData::describe(ModelFile& m) const {
  m.output = output;
  m.scaler = scaler;
  m.licence = licence;
  m.training_set = description;
  m.subjects = subjects;
  m.emotions = mien::probtalk3d::published_emotions();
  m.intensities = mien::probtalk3d::published_intensities();
}

Result<EmotionalData> open_emotional_data(const std::filesystem::path& folder,
                                          const EmotionalDataOptions& options, ConsoleProgress& progress) {
  std::error_code ec;
  if (!std::filesystem::exists(folder, ec))
    return Error{Errc::input, "'" + folder.string() + "'", "is not there",
                 "Name the folder of 3DMEAD, or make a corpus: mien corpus build -o " + folder.string() +
                     " --split train"};
  auto data = is_corpus(folder) ? open_corpus(folder, options) : open_mead(folder, options, progress);
  if (data)
    progress.say(std::to_string(data->sequences.num_train) + " sequences to learn from, " +
                 std::to_string(data->sequences.num_valid) + " to validate");
  return data;
}

}  // namespace mien::train
