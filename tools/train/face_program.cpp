#include "emotional_data.h"
#include "epoch_run.h"
#include "mien/base/number_text.h"
#include "mien/corpus/corpus_reader.h"
#include "mien/datasets/dataset.h"
#include "mien/train/corpus_data.h"
#include "mien/train/face_data.h"
#include "programs.h"

namespace mien::train {
namespace {

using torch::Tensor;

Result<Dataset> open_data(const FaceConfig& config) {
  std::optional<DatasetKind> kind;
  if (!config.layout.empty()) {
    kind = parse_dataset_kind(config.layout);
    if (!kind)
      return Error{Errc::usage, "[run] layout '" + config.layout + "'", "is not known",
                   "See docs/datasets.md for the names"};
  }
  MIEN_TRY(Dataset dataset, open_dataset(config.run.data, kind));
  const MotionSpace space = dataset.layout->space;
  const bool fits = config.architecture == Architecture::facediffuser_beat   ? space == MotionSpace::arkit
                    : config.architecture == Architecture::facediffuser_damm ? space == MotionSpace::rig
                                                                             : space == MotionSpace::vertices;
  if (fits) return dataset;
  return Error{Errc::incompatible, "'" + config.run.data.string() + "'",
               "is of the layout " + std::string(dataset.layout->name) + ", which " + config.run.system +
                   " cannot learn",
               "Vertices are for facexhubert and facediffuser_v, beat and uudamm for the two others"};
}

/// Everything that a run is made of.
struct FaceRun {
  FaceSequences sequences;
  Templates templates;  // of meshes
  ModelFile description;
  std::unique_ptr<FaceNetwork> network;
};

FaceNetwork::Head head_for(const FaceConfig& config, const ModelFile& description) {
  const std::int64_t group = align_features(2, 1, description.output.fps).group;
  const std::int64_t input = group * description.encoder->hidden_size, width = description.output.channels;
  auto num_subjects = static_cast<std::int64_t>(description.subjects.size());
  if (config.architecture == Architecture::facexhubert)
    return facexhubert::Network<Tensor>({input, config.hidden, config.decoder, num_subjects,
                                         static_cast<std::int64_t>(description.emotions.size()), width});
  facediffuser::Sizes sizes;
  sizes.num_channels = width;
  sizes.latent = config.latent;
  sizes.hidden = config.hidden;
  sizes.decoder = config.decoder;
  sizes.noise_encoder = config.noise_encoder;
  sizes.num_steps = config.has_diffusion ? config.options.diffusion_steps : 0;
  sizes.condition = input;
  if (config.has_vertex_denoiser()) {
    sizes.variant = facediffuser::Variant::vertices;
    sizes.styles_speech = config.architecture == Architecture::facediffuser_emotion;
    if (sizes.styles_speech)
      num_subjects += static_cast<std::int64_t>(description.emotions.size() + description.intensities.size());
    sizes.num_subjects = num_subjects;
    return facediffuser::VertexDenoiser<Tensor>(sizes);
  }
  if (config.architecture == Architecture::facediffuser_beat) {
    sizes.variant = facediffuser::Variant::beat;
    return facediffuser::BeatDenoiser<Tensor>(sizes);
  }
  constexpr std::int64_t kSinusoids = 5000;  // entries of the stored table
  sizes.variant = facediffuser::Variant::damm;
  if (sizes.is_diffusion()) sizes.num_steps = std::max(kSinusoids, sizes.num_steps);
  return facediffuser::DammDenoiser<Tensor>(sizes);
}

// A data set of one of FaceDiffuser's and FaceXHuBERT's layouts.
Status open_layout(const FaceConfig& config, const EncoderConfig& encoder, FaceRun& run) {
  MIEN_TRY(Dataset opened, open_data(config));
  const auto dataset = std::make_shared<const Dataset>(std::move(opened));
  const DatasetLayout& layout = *dataset->layout;
  const bool is_mesh = layout.space == MotionSpace::vertices;
  ModelFile& m = run.description;
  MIEN_TRY(m.output.channels, loaded_width(*dataset));
  m.output.space = is_mesh ? "vertices" : layout.space == MotionSpace::arkit ? "arkit" : "rig";
  m.output.fps = layout.fps;
  if (is_mesh) {
    m.output.topology = topology_of(m.output.channels / 3).name;
    m.subjects = config.subjects.empty() ? layout.train_subjects : config.subjects;
    if (m.subjects.empty()) return Error{Errc::usage, "[run] subjects", "are needed for this data set", ""};
  }
  if (config.architecture == Architecture::facexhubert) m.emotions = {"neutral", "expressive"};
  m.licence = "that of the data set '" + std::string(layout.name) + "' and of the speech encoder";
  m.training_set = "{\"layout\": \"" + std::string(layout.name) + "\"}";
  run.templates = dataset->templates;
  MIEN_TRY(
      run.sequences,
      face_sequences(dataset, {.sound = {encoder, false}, .subjects = m.subjects, .needs_neutral = is_mesh}));
  return Done{};
}

// A corpus, with ARKit's 52 curves in place of vertices or of BEAT's 51.
Status open_corpus(const FaceConfig& config, const EncoderConfig& encoder, FaceRun& run) {
  const bool has_styles = config.architecture != Architecture::facediffuser_beat;
  if (!config.layout.empty())
    return Error{Errc::usage, "[run] layout", "is of the papers' data sets, and the data are a corpus",
                 "Leave it out"};
  if (config.architecture == Architecture::facediffuser_damm)
    return Error{Errc::incompatible, "'" + config.run.data.string() + "'",
                 "is a corpus of ARKit's curves; " + config.run.system + " learns controls of a rig",
                 "Train facediffuser_beat on it"};
  CorpusDataOptions wanted;
  wanted.sound = {encoder, false};
  wanted.fps = has_styles ? 25 : dataset_layout(DatasetKind::beat).fps;
  wanted.num_takes = config.corpus.num_takes;
  wanted.subjects = config.subjects;
  wanted.needs_neutral = has_styles;
  wanted.style = has_styles ? CorpusStyle::speaker : CorpusStyle::none;
  MIEN_TRY(CorpusData corpus, corpus_data(config.run.data, config.corpus.validation, wanted));
  ModelFile& m = run.description;
  m.output = std::move(corpus.output);
  if (has_styles) m.subjects = std::move(corpus.subjects);
  if (config.architecture == Architecture::facexhubert) m.emotions = {"neutral", "expressive"};
  m.licence = std::move(corpus.licence);
  m.training_set = std::move(corpus.description);
  run.sequences = std::move(corpus.sequences);
  return Done{};
}

// 3DMEAD's meshes, or a corpus with emotions.
Status open_emotional(const FaceConfig& config, const EncoderConfig& encoder, FaceRun& run,
                      ConsoleProgress& progress) {
  MIEN_TRY(EmotionalData data, open_emotional_data(config.run.data,
                                                   {.kind = DatasetKind::mead_vertices,
                                                    .sound = {encoder, false},
                                                    .subjects = config.subjects,
                                                    .needs_neutral = true,
                                                    .corpus = config.corpus},
                                                   progress));
  data.describe(run.description);
  run.sequences = std::move(data.sequences);
  run.templates = std::move(data.templates);
  return Done{};
}

Status open_sequences(const FaceConfig& config, const EncoderConfig& encoder, FaceRun& run,
                      ConsoleProgress& progress) {
  if (config.architecture == Architecture::facediffuser_emotion)
    return open_emotional(config, encoder, run, progress);
  return is_corpus(config.run.data) ? open_corpus(config, encoder, run) : open_layout(config, encoder, run);
}

void describe_network(const FaceConfig& config, const EncoderConfig& encoder, ModelFile& m) {
  m.architecture = config.architecture;
  m.name = config.run.name.empty() ? config.run.system : config.run.name;
  m.encoder = encoder;
  if (config.architecture != Architecture::facexhubert && config.has_diffusion)
    m.diffusion = {std::string(beta_schedule_name(config.options.schedule)), config.options.diffusion_steps};
  if (config.decoder.kind == DecoderKind::transformer) m.sizes["decoder_heads"] = config.decoder.heads;
  if (config.has_diffusion && config.noise_encoder != facediffuser::NoiseEncoder::conv_max)
    m.noise_encoder = facediffuser::noise_encoder_name(config.noise_encoder);
  m.training_config = config.run.text;
}

Result<FaceRun> prepare(const FaceConfig& config, ConsoleProgress& progress) {
  FaceRun run;
  MIEN_TRY(const auto source, open_encoder(config.encoder, config.options.spec_augment));
  MIEN_TRY([[maybe_unused]] const auto opened, open_sequences(config, source.config, run, progress));
  describe_network(config, source.config, run.description);
  run.network.reset(new FaceNetwork{SpeechEncoder<Tensor>(source.config), head_for(config, run.description),
                                    run.description.output.fps});
  initialise_as_published(*run.network, config.options.seed);
  MIEN_TRY([[maybe_unused]] const auto loaded, source.load_into(run.network->encoder));
  for (const auto& e : parameters(*run.network)) *e.slot = e.slot->detach().to(config.options.device);
  return run;
}

Status write_model(FaceRun& run, const std::filesystem::path& path) {
  auto entries = parameters(*run.network);
  std::vector<Tensor> neutral;
  neutral.reserve(run.templates.size());  // entries point into it
  for (const auto& [subject, values] : run.templates) {
    neutral.push_back(torch::from_blob(const_cast<float*>(values.data()),
                                       {static_cast<std::int64_t>(values.size())}, torch::kFloat));
    entries.push_back({std::string(ModelFile::kTemplatePrefix) + subject, &neutral.back(), false});
  }
  return save_parameters(entries, path, false, to_metadata(run.description));
}

}  // namespace

Status train_face(const FaceConfig& config, ConsoleProgress& progress) {
  MIEN_TRY(FaceRun run, prepare(config, progress));
  MIEN_TRY(const auto learning, freeze(parameters(*run.network), config.frozen));
  MIEN_TRY([[maybe_unused]] const auto begun, config.run.begin());
  FaceStage stage(*run.network, std::move(run.sequences), config.options);
  auto options = StageOptions::plain_adam(config.num_epochs * stage.steps_per_epoch(), config.learning_rate);
  options.checkpoint_every = config.checkpoint_every;
  const auto end_epoch = [&](std::int64_t epoch) -> Status {
    MIEN_TRY(const double valid, stage.validation_loss(epoch));
    progress.say("epoch " + std::to_string(epoch) + ": validation loss " +
                 shortest(static_cast<float>(valid)));
    if (config.export_every > 0 && epoch > 0 && epoch % config.export_every == 0)
      return write_model(run, config.run.work_folder / ("epoch_" + std::to_string(epoch) + ".safetensors"));
    return Done{};
  };
  MIEN_TRY([[maybe_unused]] const auto done,
           run_epochs(config.run,
                      {learning, options, stage.steps_per_epoch(),
                       [&](std::int64_t step) { return stage.loss(step); }, end_epoch},
                      progress));
  MIEN_TRY([[maybe_unused]] const auto saved, write_model(run, config.run.output));
  progress.say("wrote " + config.run.output.string());
  return Done{};
}

Status snapshot_face(const FaceConfig& config, const std::filesystem::path& path, ConsoleProgress& progress) {
  MIEN_TRY(FaceRun run, prepare(config, progress));
  MIEN_TRY(const auto learning, freeze(parameters(*run.network), config.frozen));
  MIEN_TRY(const auto step, load_stage_average(learning, config.run.checkpoint()));
  progress.say("checkpoint of step " + std::to_string(step));
  return write_model(run, path);
}

}  // namespace mien::train
