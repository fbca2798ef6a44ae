// Published systems from file to motion, on small models with random weights.
#include "mien/models/face_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "mien/models/alignment.h"
#include "mien/models/facediffuser/plain_sampler.h"
#include "mien/models/facexhubert/network.h"
#include "small_face_model.h"

namespace mien {
namespace {

using testing::HasSubstr;

// In a file of this process; each call replaces it.
template <class Network>
std::filesystem::path write_model(const ModelFile& m, Network network) {
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("mien_face_model_" + std::to_string(getpid()) + ".safetensors");
  write_face_model(path, m, std::move(network));
  return path;
}

std::filesystem::path write_mesh_model() {
  return write_model(face_description(Architecture::facediffuser_v),
                     facediffuser::VertexDenoiser<Tensor>(small_mesh_sizes()));
}

AudioClip clip(double seconds) {
  AudioClip c;
  c.samples.resize(static_cast<std::size_t>(seconds * 16000));
  NoiseField(1, 1).normal(0, 0, c.samples);
  return c;
}

TEST(FaceModel, AnimatesAMesh) {
  const auto model = FaceModel::load(write_mesh_model());
  ASSERT_TRUE(model) << model.error().message();
  Progress progress;
  const AudioClip speech = clip(1.3);
  FaceOptions options;
  options.style = "F1";
  options.seed = 4;
  const auto takes = animate(*model, speech, options, 2, 2, progress);
  ASSERT_TRUE(takes) << takes.error().message();
  const Motion& first = takes->front();
  EXPECT_EQ(first.space, MotionSpace::vertices);
  EXPECT_EQ(first.num_channels(), 60);
  EXPECT_EQ(first.fps, 25);
  EXPECT_EQ(first.num_frames(), num_diffuser_frames(static_cast<std::int64_t>(speech.samples.size()), 25));
  EXPECT_NE(first.values, takes->back().values);
  const auto again = animate(*model, speech, options, 1, 1, progress);
  EXPECT_EQ(again->front().values, first.values) << "a take depends on its seed alone";
  options.style = "M2";
  EXPECT_NE(animate(*model, speech, options, 1, 1, progress)->front().values, first.values);
  options.respacing = "ddim4";
  options.sampler = {.kind = SamplerKind::ddim};
  options.skip = 1;
  EXPECT_TRUE(animate(*model, speech, options, 1, 1, progress));
}

TEST(FaceModel, EncodesInPiecesAndInFewerBits) {
  const auto path = write_mesh_model();
  const auto model = FaceModel::load(path);
  ASSERT_TRUE(model) << model.error().message();
  Progress progress;
  const AudioClip speech = clip(3);
  FaceOptions options;
  const auto whole = animate(*model, speech, options, 1, 1, progress);
  ASSERT_TRUE(whole) << whole.error().message();
  options.windows = EncoderWindows{.frames = 40, .left = 1000, .right = 1000};
  const auto all_context = animate(*model, speech, options, 1, 2, progress);
  ASSERT_TRUE(all_context) << all_context.error().message();
  ASSERT_EQ(all_context->front().values.size(), whole->front().values.size());
  for (std::size_t i = 0; i < whole->front().values.size(); ++i)
    ASSERT_NEAR(all_context->front().values[i], whole->front().values[i], 1e-4) << i;
  options.windows = EncoderWindows{.frames = 40, .left = 10, .right = 10};
  const auto little_context = animate(*model, speech, options, 1, 1, progress);
  EXPECT_EQ(little_context->front().num_frames(), whole->front().num_frames());
  EXPECT_NE(little_context->front().values, whole->front().values);

  if (!encoder_precision_available(EncoderPrecision::int8)) return;
  const auto coarse = FaceModel::load(path, 1, EncoderPrecision::int8);
  ASSERT_TRUE(coarse) << coarse.error().message();
  const auto rounded = animate(*coarse, speech, {}, 1, 1, progress);
  EXPECT_EQ(rounded->front().num_frames(), whole->front().num_frames());
  EXPECT_NE(rounded->front().values, whole->front().values);
}

// Six seconds are more than one block of frames, so two of the three end before the last.
TEST(FaceModel, RecordingsSideBySideGiveWhatEachGivesAlone) {
  const auto model = FaceModel::load(write_mesh_model());
  ASSERT_TRUE(model) << model.error().message();
  Progress progress;
  FaceOptions options;
  options.seed = 4;
  const std::vector<AudioClip> speech = {clip(1.3), clip(6), clip(0.001), clip(2)};
  std::vector<std::vector<std::vector<float>>> got(speech.size(), std::vector<std::vector<float>>(2));
  std::vector<SamplesInMemory> sources;
  for (const auto& one : speech) sources.emplace_back(one.samples);
  std::vector<FaceClip> clips;
  for (std::size_t i = 0; i < speech.size(); ++i)
    clips.push_back({&sources[i], [&own = got[i]](int take, std::span<const float> values) -> Status {
                       auto& frames = own[static_cast<std::size_t>(take)];
                       frames.insert(frames.end(), values.begin(), values.end());
                       return Done{};
                     }});
  const auto done = animate(*model, clips, options, 2, 2, progress);
  ASSERT_EQ(done.size(), speech.size());
  for (std::size_t i = 0; i < speech.size(); ++i) {
    const auto alone = animate(*model, speech[i], options, 2, 1, progress);
    ASSERT_EQ(static_cast<bool>(alone), i != 2);
    ASSERT_EQ(static_cast<bool>(done[i]), i != 2);
    if (!alone) {
      EXPECT_EQ(done[i].error().message(), alone.error().message());
      continue;
    }
    for (std::size_t take = 0; take < 2; ++take) EXPECT_EQ(got[i][take], (*alone)[take].values) << i;
  }
}

TEST(FaceModel, TakesLongSpeechInWindowsAndSaysSo) {
  const auto model = FaceModel::load(write_mesh_model());
  ASSERT_TRUE(model) << model.error().message();
  Progress progress;
  FaceOptions in_windows, at_once;
  in_windows.windows = windows_of(20);
  at_once.windows = EncoderWindows();
  const auto performed = [&](double seconds, const FaceOptions& options) {
    return animate(*model, clip(seconds), options, 1, 2, progress);
  };
  const auto chosen = performed(61, {}), windows = performed(61, in_windows), whole = performed(61, at_once);
  ASSERT_TRUE(chosen && windows && whole);
  EXPECT_EQ(chosen->front().values, windows->front().values);
  EXPECT_NE(chosen->front().values, whole->front().values);
  ASSERT_EQ(chosen.warnings.size(), 1u);
  EXPECT_EQ(chosen.warnings[0].find("speech of 61 s is taken in windows of 20 s"), 0u) << chosen.warnings[0];
  EXPECT_TRUE(windows.warnings.empty() && whole.warnings.empty());
  EXPECT_TRUE(performed(59, {}).warnings.empty());
}

TEST(FaceModel, AnimatesRigsAndPredictsExpressions) {
  Progress progress;
  facediffuser::Sizes beat{.variant = facediffuser::Variant::beat,
                           .num_channels = 7,
                           .latent = 4,
                           .hidden = 5,
                           .num_steps = 12,
                           .condition = 32};
  const auto rig = FaceModel::load(write_model(face_description(Architecture::facediffuser_beat),
                                               facediffuser::BeatDenoiser<Tensor>(beat)));
  ASSERT_TRUE(rig) << rig.error().message();
  const auto curves = animate(*rig, clip(0.9), {}, 1, 1, progress);
  ASSERT_TRUE(curves) << curves.error().message();
  EXPECT_EQ(curves->front().num_frames(), num_diffuser_frames(14400, 30));

  const facexhubert::Sizes sizes{
      .input = 32, .hidden = 5, .num_subjects = 2, .num_emotions = 2, .num_channels = 60};
  const auto mesh = FaceModel::load(
      write_model(face_description(Architecture::facexhubert), facexhubert::Network<Tensor>(sizes)));
  ASSERT_TRUE(mesh) << mesh.error().message();
  FaceOptions options;
  const auto expressive = animate(*mesh, clip(0.9), options, 1, 1, progress);
  ASSERT_TRUE(expressive) << expressive.error().message();
  EXPECT_EQ(expressive->front().num_frames(), small_face_encoder().num_frames(14400) / 2);
  options.emotion = "neutral";
  EXPECT_NE(animate(*mesh, clip(0.9), options, 1, 1, progress)->front().values, expressive->front().values);
}

// What training makes of the papers' ablations runs too, where there is no fast path on the plain sampler.
TEST(FaceModel, AnimatesAblations) {
  Progress progress;
  FaceOptions first, second;
  first.seed = 1;
  second.seed = 2;
  second.style = "M2";
  const auto motion = [&](const ModelFile& m, auto network, const FaceOptions& options) {
    const auto model = FaceModel::load(write_model(m, std::move(network)));
    EXPECT_TRUE(model) << model.error().message();
    const auto takes = animate(*model, clip(0.9), options, 2, 1, progress);
    EXPECT_TRUE(takes) << takes.error().message();
    EXPECT_GT(takes->front().num_frames(), 10);
    EXPECT_EQ(takes->front().num_frames(), takes->back().num_frames());
    for (const float v : takes->front().values) EXPECT_TRUE(std::isfinite(v));
    const bool is_drawn = m.diffusion.has_value();
    EXPECT_EQ(takes->front().values != takes->back().values, is_drawn) << "takes differ by their noise alone";
    return takes->front().values;
  };
  for (const DecoderKind kind : {DecoderKind::rnn, DecoderKind::lstm, DecoderKind::transformer}) {
    SCOPED_TRACE(decoder_kind_name(kind));
    const DecoderSizes decoder{.kind = kind, .num_layers = 2, .heads = 2};
    ModelFile mesh = face_description(Architecture::facediffuser_v),
              expressive = face_description(Architecture::facexhubert);
    if (kind == DecoderKind::transformer) mesh.sizes["decoder_heads"] = expressive.sizes["decoder_heads"] = 2;
    facediffuser::Sizes sizes = small_mesh_sizes();
    sizes.decoder = decoder;
    const facediffuser::VertexDenoiser<Tensor> denoiser(sizes);
    EXPECT_NE(motion(mesh, denoiser, first), motion(mesh, denoiser, second));
    const facexhubert::Network<Tensor> network({.input = 32,
                                                .hidden = 6,
                                                .decoder = decoder,
                                                .num_subjects = 2,
                                                .num_emotions = 2,
                                                .num_channels = 60});
    EXPECT_NE(motion(expressive, network, first), motion(expressive, network, second));
  }

  using facediffuser::NoiseEncoder;
  ModelFile mesh = face_description(Architecture::facediffuser_v);
  const auto published = motion(mesh, facediffuser::VertexDenoiser<Tensor>(small_mesh_sizes()), first);
  for (const NoiseEncoder kind : {NoiseEncoder::conv_average, NoiseEncoder::mlp}) {
    facediffuser::Sizes sizes = small_mesh_sizes();
    sizes.noise_encoder = kind;
    mesh.noise_encoder = noise_encoder_name(kind);
    EXPECT_NE(motion(mesh, facediffuser::VertexDenoiser<Tensor>(sizes), first), published);
  }

  for (const auto architecture :
       {Architecture::facediffuser_v, Architecture::facediffuser_beat, Architecture::facediffuser_damm}) {
    SCOPED_TRACE(architecture_name(architecture));
    ModelFile m = face_description(architecture);
    m.diffusion.reset();
    facediffuser::Sizes sizes = small_mesh_sizes();
    sizes.num_steps = 0;
    if (architecture == Architecture::facediffuser_v) {
      motion(m, facediffuser::VertexDenoiser<Tensor>(sizes), first);
      continue;
    }
    sizes.num_channels = m.output.channels;
    sizes.variant = architecture == Architecture::facediffuser_beat ? facediffuser::Variant::beat
                                                                    : facediffuser::Variant::damm;
    if (architecture == Architecture::facediffuser_beat)
      motion(m, facediffuser::BeatDenoiser<Tensor>(sizes), first);
    else
      motion(m, facediffuser::DammDenoiser<Tensor>(sizes), first);
  }
}

TEST(FaceModel, RefusesAblationsThatAreNotDescribed) {
  facediffuser::Sizes sizes = small_mesh_sizes();
  sizes.decoder = {.kind = DecoderKind::transformer, .num_layers = 1, .heads = 2};
  ModelFile heads = face_description(Architecture::facediffuser_v), split = heads, noise = heads, mlp = heads,
            steps = heads;
  split.sizes["decoder_heads"] = 4;
  noise.noise_encoder = "conv_median";
  mlp.noise_encoder = "mlp";
  const facediffuser::VertexDenoiser<Tensor> published(small_mesh_sizes());
  const facediffuser::VertexDenoiser<Tensor> transformer(sizes);
  const auto refused = [&](const ModelFile& m, const auto& network) {
    const auto model = FaceModel::load(write_model(m, network));
    ASSERT_FALSE(model);
    EXPECT_EQ(model.error().code, Errc::incompatible) << model.error().message();
  };
  refused(heads, transformer);
  refused(split, transformer);
  refused(noise, published);
  refused(mlp, published);
  sizes = small_mesh_sizes();
  sizes.num_steps = 0;
  refused(steps, facediffuser::VertexDenoiser<Tensor>(sizes));
}

TEST(FaceModel, RefusesWhatItDoesNotKnow) {
  const auto model = FaceModel::load(write_mesh_model());
  ASSERT_TRUE(model);
  Progress progress;
  const auto refusal = [&](const FaceOptions& options, const AudioClip& speech) {
    const auto takes = animate(*model, speech, options, 1, 1, progress);
    return takes ? Error{Errc::failed, "", "", ""} : takes.error();
  };
  FaceOptions style, neutral, emotion, respacing, skip;
  style.style = "F9";
  neutral.neutral = "F1";
  emotion.emotion = "happy";
  respacing.respacing = "13";
  skip.skip = 12;
  EXPECT_THAT(refusal(style, clip(1)).message(), HasSubstr("It knows: F1, M2"));
  EXPECT_THAT(refusal(neutral, clip(1)).message(), HasSubstr("It knows: M2"));
  for (const auto& options : {style, neutral, emotion, respacing, skip})
    EXPECT_EQ(refusal(options, clip(1)).code, Errc::usage);
  for (const std::size_t num_samples : {0u, 1u, 399u, 400u, 1279u}) {
    AudioClip speech;
    speech.samples.resize(num_samples);
    EXPECT_EQ(refusal({}, speech).code, Errc::input) << num_samples;
  }
  progress.cancel();
  EXPECT_EQ(refusal({}, clip(1)).code, Errc::cancelled);
}

TEST(FaceModel, RefusesADescriptionThatDoesNotFitTheWeights) {
  const facediffuser::VertexDenoiser<Tensor> network(small_mesh_sizes());
  ModelFile channels = face_description(Architecture::facediffuser_v), steps = channels, subjects = channels,
            encoder = channels, other = channels;
  channels.output.channels = 63;
  steps.diffusion->steps = 13;
  subjects.subjects = {"F1"};
  encoder.encoder->hidden_size = 24;
  encoder.encoder->intermediate_size = 24;
  other.architecture = Architecture::facexhubert;
  for (const auto& wrong : {channels, steps, subjects, encoder, other}) {
    const auto model = FaceModel::load(write_model(wrong, network));
    ASSERT_FALSE(model);
    EXPECT_EQ(model.error().code, Errc::incompatible) << model.error().message();
  }
}

}  // namespace
}  // namespace mien
