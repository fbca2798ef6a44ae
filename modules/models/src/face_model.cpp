#include "mien/models/face_model.h"

#include <algorithm>

#include "face_parts.h"
#include "mien/core/arkit.h"
#include "mien/core/flame_parameters.h"
#include "mien/core/rig_controls.h"
#include "mien/models/alignment.h"
#include "mien/models/probtalk3d/conventions.h"
#include "mien/models/runtime_parameters.h"
#include "unfit.h"

namespace mien {
namespace {

// A network whose sizes are those of the stored weights.
template <class Network, class Sizes>
Result<std::shared_ptr<const Network>> load_network(const SafetensorsFile& file, const Result<Sizes>& sizes) {
  if (!sizes) return sizes.error();
  auto network = std::make_shared<Network>(*sizes);
  LoadRuntime load(file);
  for (const std::string_view prefix :
       {ModelFile::kEncoderPrefix, ModelFile::kTemplatePrefix, ModelFile::kRegionPrefix})
    load.leave_out(std::string(prefix));
  network->visit(load);
  const Status status = load.finish();
  if (!status) return status.error();
  return std::shared_ptr<const Network>(std::move(network));
}

// What shapes do not tell of a decoder.
Status describe_decoder(const ModelFile& description, std::int64_t hidden, DecoderSizes& decoder) {
  if (decoder.kind != DecoderKind::transformer) return Done{};
  const auto heads = description.sizes.find("decoder_heads");
  if (heads == description.sizes.end() || heads->second < 1 || hidden % heads->second != 0)
    return unfit("does not say how many heads its transformer has, or " + std::to_string(hidden) +
                 " numbers cannot be split among them");
  decoder.heads = heads->second;
  return Done{};
}

Result<facexhubert::Sizes> facexhubert_sizes(const SafetensorsFile& file, const ModelFile& description) {
  MIEN_TRY(facexhubert::Sizes sizes, facexhubert::sizes_of(file));
  MIEN_TRY([[maybe_unused]] const auto known, describe_decoder(description, sizes.hidden, sizes.decoder));
  return sizes;
}

Result<facediffuser::Sizes> diffuser_sizes(const SafetensorsFile& file, const ModelFile& description) {
  using facediffuser::NoiseEncoder;
  const bool has_emotions = description.architecture == Architecture::facediffuser_emotion;
  MIEN_TRY(facediffuser::Sizes sizes, facediffuser::sizes_of(file, has_emotions));
  MIEN_TRY([[maybe_unused]] const auto known, describe_decoder(description, sizes.hidden, sizes.decoder));
  if (description.noise_encoder.empty()) return sizes;
  const auto kind = facediffuser::parse_noise_encoder(description.noise_encoder);
  const bool is_mlp = sizes.noise_encoder == NoiseEncoder::mlp;
  if (!kind || (*kind == NoiseEncoder::mlp) != is_mlp)
    return unfit("has the noise encoder '" + description.noise_encoder +
                 "', which is not known or not that of its weights");
  sizes.noise_encoder = *kind;
  return sizes;
}

// The latent and frame-by-frame sampler knows the published form alone.
template <class Network, class... Threads>
std::shared_ptr<const facediffuser::FoldedDenoiser> folded(const std::shared_ptr<const Network>& network,
                                                           Threads... num_threads) {
  const facediffuser::Sizes& s = network->sizes;
  if (s.decoder.kind != DecoderKind::gru || !s.is_diffusion() ||
      s.noise_encoder != facediffuser::NoiseEncoder::conv_max)
    return nullptr;
  return std::make_shared<const facediffuser::FoldedDenoiser>(facediffuser::fold(network, num_threads...));
}

// No tensor tells it.
std::int64_t heads_of(const ModelFile& description) {
  const auto found = description.sizes.find("heads");
  return found == description.sizes.end() ? 0 : found->second;
}

// How many of its steps the authors' program walks, the last ones.
constexpr std::int64_t kEmotionalSteps = 100;

Status load_decoder(const SafetensorsFile& file, FaceModel::Parts& parts, int num_threads) {
  using namespace facediffuser;
  switch (parts.description.architecture) {
    case Architecture::facexhubert: {
      MIEN_TRY(parts.facexhubert,
               load_network<facexhubert::Network<Tensor>>(file, facexhubert_sizes(file, parts.description)));
      return Done{};
    }
    case Architecture::facediffuser_v:
    case Architecture::facediffuser_emotion: {
      MIEN_TRY(parts.vertices,
               load_network<VertexDenoiser<Tensor>>(file, diffuser_sizes(file, parts.description)));
      parts.folded = folded(parts.vertices, num_threads);
      return Done{};
    }
    case Architecture::facediffuser_beat: {
      MIEN_TRY(parts.beat, load_network<BeatDenoiser<Tensor>>(file, diffuser_sizes(file, parts.description)));
      parts.folded = folded(parts.beat);
      return Done{};
    }
    case Architecture::facediffuser_damm: {
      MIEN_TRY(parts.damm, load_network<DammDenoiser<Tensor>>(file, diffuser_sizes(file, parts.description)));
      parts.folded = folded(parts.damm);
      return Done{};
    }
    case Architecture::probtalk3d: {
      const auto sizes = probtalk3d::sizes_of(stored_shapes(file), heads_of(parts.description));
      MIEN_TRY(parts.probtalk3d, load_network<probtalk3d::Network<Tensor>>(file, sizes));
      return Done{};
    }
    default:
      return unfit("is not FaceXHuBERT, FaceDiffuser or ProbTalk3D but '" +
                   std::string(architecture_name(parts.description.architecture)) + "'");
  }
}

// What the description says must be what the weights are: later code relies on it.
Status check(const FaceModel::Parts& parts, std::int64_t condition, std::int64_t channels,
             std::int64_t num_subjects, std::int64_t num_emotions, std::int64_t num_steps) {
  const ModelFile& d = parts.description;
  const auto differ = [](const std::string& what, std::int64_t said, std::int64_t stored) {
    return unfit("its description has " + std::to_string(said) + " " + what + ", its weights " +
                 std::to_string(stored));
  };
  if (d.output.channels != channels) return differ("channels", d.output.channels, channels);
  if (d.output.space == "vertices" && channels % 3 != 0)
    return unfit("has " + std::to_string(channels) + " channels, which is not three for every vertex");
  if (!(d.output.fps > 0)) return unfit("does not say its frame rate");
  const auto subjects = static_cast<std::int64_t>(d.subjects.size());
  if (num_subjects > 0 && subjects != num_subjects) return differ("subjects", subjects, num_subjects);
  const auto emotions = static_cast<std::int64_t>(d.emotions.size());
  if (num_emotions > 0 && emotions != num_emotions) return differ("emotions", emotions, num_emotions);
  if (num_steps == 0 && d.diffusion) return unfit("says that it diffuses, but has no time tokens");
  if (num_steps > 0 && (!d.diffusion || d.diffusion->steps < 1 || d.diffusion->steps > num_steps))
    return unfit("does not say how many diffusion steps it was trained with, or more than its " +
                 std::to_string(num_steps) + " time tokens");
  if (d.scaler && (static_cast<std::int64_t>(d.scaler->scale.size()) != channels ||
                   static_cast<std::int64_t>(d.scaler->min.size()) != channels))
    return unfit("has a scaler that does not fit its channels");
  const std::int64_t group = align_features(2, 1, d.output.fps).group;
  if (group * parts.encoder.config().hidden_size != condition)
    return unfit("takes " + std::to_string(condition) + " speech features a frame, but " +
                 std::to_string(group) + " frames of its encoder have " +
                 std::to_string(group * parts.encoder.config().hidden_size));
  return Done{};
}

// Styles of identities, emotions and intensities side by side.
Status check_styles(const ModelFile& d, std::int64_t num_columns) {
  if (d.subjects.empty() || d.emotions.empty() || d.intensities.empty())
    return unfit("names no subjects, emotions or intensities");
  if (static_cast<std::int64_t>(d.subjects.size() + d.emotions.size() + d.intensities.size()) != num_columns)
    return unfit("its subjects, emotions and intensities are not the " + std::to_string(num_columns) +
                 " columns of its style");
  return Done{};
}

}  // namespace

bool FaceModel::runs(Architecture architecture) {
  switch (architecture) {
    case Architecture::facexhubert:
    case Architecture::facediffuser_v:
    case Architecture::facediffuser_beat:
    case Architecture::facediffuser_damm:
    case Architecture::facediffuser_emotion:
    case Architecture::probtalk3d:
      return true;
    case Architecture::default_model:
    case Architecture::speech_encoder:
    case Architecture::said_vae:
    case Architecture::said:
    case Architecture::probtalk3d_prior:
      break;
  }
  return false;
}

FaceOptions published_options(const ModelFile& model) {
  FaceOptions options;
  if (model.architecture != Architecture::facediffuser_emotion || !model.diffusion) return options;
  options.sampler.kind = SamplerKind::ddim;
  options.skip = std::max<std::int64_t>(0, model.diffusion->steps - kEmotionalSteps);
  return options;
}

FaceModel::FaceModel(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
FaceModel::FaceModel(FaceModel&&) noexcept = default;
FaceModel& FaceModel::operator=(FaceModel&&) noexcept = default;
FaceModel::~FaceModel() = default;

const ModelFile& FaceModel::description() const { return parts_->description; }

Result<FaceModel> FaceModel::load(const std::filesystem::path& path, int num_threads,
                                  EncoderPrecision precision) {
  const std::string name = "loading model '" + path.string() + "'";
  auto opened = SafetensorsFile::open(path);
  if (!opened) return opened.error();
  const SafetensorsFile& file = *opened;
  const auto fail = [&](const Error& error) { return within(error, name); };

  auto description = read_model_file(file.metadata());
  if (!description) return fail(description.error());
  if (!runs(description->architecture))
    return fail(unfit("is a '" + std::string(architecture_name(description->architecture)) + "'"));
  if (!description->encoder) return fail(unfit("has no speech encoder"));
  const EncoderConfig config = *description->encoder;
  auto encoder = EncoderRuntime::load(file, config, std::string(ModelFile::kEncoderPrefix), precision);
  if (!encoder) return fail(encoder.error());
  auto parts =
      std::make_unique<Parts>(Parts{.description = std::move(*description), .encoder = std::move(*encoder)});
  if (const Status status = load_decoder(file, *parts, num_threads); !status) return fail(status.error());

  Status fits = Done{};
  if (parts->facexhubert != nullptr) {
    const auto& s = parts->facexhubert->sizes;
    fits = check(*parts, s.input, s.num_channels, s.num_subjects, s.num_emotions, 0);
  } else if (parts->probtalk3d != nullptr) {
    const auto& s = parts->probtalk3d->sizes;
    fits = check(*parts, s.condition, s.channels, 0, 0, 0);
    if (fits) fits = check_styles(parts->description, s.style);
    constexpr auto kMost = static_cast<std::int64_t>(kNumFlameExpression + kNumFlameJaw);
    const bool is_flame = parts->description.output.space == "flame";
    if (fits && is_flame && (s.channels <= probtalk3d::kNumJaw || s.channels > kMost))
      fits =
          unfit("has " + std::to_string(s.channels) + " channels, which are not FLAME's expression and jaw");
    if (fits && !is_flame && parts->description.output.space != "arkit")
      fits = unfit("moves '" + parts->description.output.space + "', neither FLAME's parameters nor ARKit's");
  } else {
    const auto s = parts->diffuser_sizes();
    const bool has_emotions = parts->description.architecture == Architecture::facediffuser_emotion;
    fits = check(*parts, s.condition, s.num_channels, has_emotions ? 0 : s.num_subjects, 0, s.num_steps);
    if (fits && has_emotions) fits = check_styles(parts->description, s.num_subjects);
  }
  if (!fits) return fail(fits.error());
  for (const std::string& subject : template_subjects(file)) {
    auto values = read_template(file, subject);
    if (!values) return fail(values.error());
    if (static_cast<std::int64_t>(values->size()) != parts->description.output.channels)
      return fail(unfit("has a neutral face '" + subject + "' of another size"));
    const auto width = static_cast<std::int64_t>(values->size());
    parts->neutrals.emplace_back(subject, Tensor({1, width}, *values));
  }
  return FaceModel(std::move(parts));
}

Motion FaceModel::empty_motion() const {
  const ModelOutput& output = parts_->description.output;
  if (output.space == "vertices") {
    Topology topology = topology_of(output.channels / 3);
    if (!output.topology.empty()) topology.name = output.topology;
    return vertex_motion(topology, output.fps);
  }
  Motion motion;
  motion.fps = output.fps;
  if (output.space == "flame") {
    motion.space = MotionSpace::flame;
    motion.channels = flame_channels(0, static_cast<std::size_t>(output.channels) - kNumFlameJaw);
    return motion;
  }
  motion.space = output.space == "arkit" ? MotionSpace::arkit : MotionSpace::rig;
  if (motion.space == MotionSpace::arkit)  // of BEAT, or of the corpus
    motion.channels = arkit_order(output.channels == static_cast<std::int64_t>(kNumArkit) ? ArkitOrder::apple
                                                                                          : ArkitOrder::beat);
  else
    motion.channels = uudamm_controls();
  if (motion.num_channels() != output.channels) {
    motion.space = MotionSpace::rig;
    motion.channels.clear();
    for (std::int64_t c = 0; c < output.channels; ++c)
      motion.channels.push_back("channel_" + std::to_string(c));
  }
  return motion;
}

}  // namespace mien
