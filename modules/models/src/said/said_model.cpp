#include "mien/models/said/said_model.h"

#include <algorithm>

#include "../unfit.h"
#include "mien/base/contract.h"
#include "mien/core/arkit.h"
#include "mien/models/runtime_parameters.h"
#include "mien/models/said/speech_front.h"

namespace mien {
namespace {

Status check(const ModelFile& d, const said::Sizes& sizes) {
  if (d.output.channels != sizes.num_channels)
    return unfit("its description has " + std::to_string(d.output.channels) + " channels, its weights " +
                 std::to_string(sizes.num_channels));
  if (d.output.fps != kSaidFps) return unfit("does not move at 60 frames a second");
  if (!d.diffusion || !parse_beta_schedule(d.diffusion->schedule))
    return unfit("does not say how it was diffused");
  if (d.encoder->hidden_size != sizes.speech)
    return unfit("takes " + std::to_string(sizes.speech) + " speech features a frame, its encoder gives " +
                 std::to_string(d.encoder->hidden_size));
  return Done{};
}

}  // namespace

struct SaidModel::Parts {
  ModelFile description;
  EncoderRuntime encoder;
  said::FastDenoiser denoiser;
};

SaidModel::SaidModel(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
SaidModel::SaidModel(SaidModel&&) noexcept = default;
SaidModel& SaidModel::operator=(SaidModel&&) noexcept = default;
SaidModel::~SaidModel() = default;

const ModelFile& SaidModel::description() const { return parts_->description; }
const said::FastDenoiser& SaidModel::denoiser() const { return parts_->denoiser; }
const EncoderRuntime& SaidModel::encoder() const { return parts_->encoder; }

Result<SaidModel> SaidModel::load(const std::filesystem::path& path, EncoderPrecision precision) {
  const std::string name = "loading model '" + path.string() + "'";
  const auto file = SafetensorsFile::open(path);
  if (!file) return file.error();
  const auto fail = [&](const Error& error) { return within(error, name); };
  auto description = read_model_file(file->metadata());
  if (!description) return fail(description.error());
  if (description->architecture != Architecture::said)
    return fail(unfit("is a '" + std::string(architecture_name(description->architecture)) + "'"));
  if (!description->encoder) return fail(unfit("has no speech encoder"));
  auto sizes = said::sizes_of(*file);
  if (!sizes) return fail(sizes.error());
  const auto bias = description->sizes.find("alignment_bias");
  sizes->is_aligned = bias == description->sizes.end() || bias->second != 0;
  if (const Status fits = check(*description, *sizes); !fits) return fail(fits.error());
  auto encoder =
      EncoderRuntime::load(*file, *description->encoder, std::string(ModelFile::kEncoderPrefix), precision);
  if (!encoder) return fail(encoder.error());
  said::Network<PlainWeights> network(*sizes);
  LoadRuntime load(*file);
  load.leave_out(std::string(ModelFile::kEncoderPrefix));
  network.visit(load);
  if (const Status loaded = load.finish(); !loaded) return fail(loaded.error());
  said::FastDenoiser denoiser(network, description->diffusion->steps, backend_of(precision));
  return SaidModel(
      std::make_unique<Parts>(Parts{std::move(*description), std::move(*encoder), std::move(denoiser)}));
}

Motion SaidModel::empty_motion() const {
  Motion motion{MotionSpace::arkit, arkit_order(ArkitOrder::said), kSaidFps, {}};
  const std::int64_t channels = parts_->description.output.channels;
  if (motion.num_channels() == channels) return motion;
  motion.space = MotionSpace::rig;  // other shapes than those that were published
  motion.channels.clear();
  for (std::int64_t c = 0; c < channels; ++c) motion.channels.push_back("channel_" + std::to_string(c));
  return motion;
}

DiffusionProcess SaidModel::process() const {
  const ModelDiffusion& diffusion = *parts_->description.diffusion;
  return said::training_process(*parse_beta_schedule(diffusion.schedule), diffusion.steps);
}

Result<Tensor> SaidModel::context(const AudioClip& clip, int num_threads) const {
  contract(clip.sample_rate_hz == kModelSampleRateHz, "SaidModel: the clip must be at 16 kHz");
  EncodeOptions encoding;
  encoding.num_threads = num_threads;
  MIEN_TRY(const Tensor features, said::encode_speech(parts_->encoder, clip.samples, encoding));
  return parts_->denoiser.context(features);
}

}  // namespace mien
