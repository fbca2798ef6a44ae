// Joins of edits with the published systems, made small, with random weights: how what is kept and the join
// work together, not how trained ones move (docs/editing.md has the table).
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numeric>

#include "mien/base/random.h"
#include "mien/models/edit.h"
#include "mien/models/said/network.h"
#include "mien/models/said/said_model.h"
#include "seam_measure.h"
#include "small_face_model.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

/// Four seconds of noise that comes and goes.
AudioClip speech() {
  AudioClip clip;
  clip.samples.resize(64000);
  NoiseField(1, 1).normal(0, 0, clip.samples);
  for (std::size_t i = 0; i < clip.samples.size(); ++i)
    clip.samples[i] *= static_cast<float>(0.1 + 0.1 * std::sin(static_cast<double>(i) / 1500));
  return clip;
}

template <class Model, class Network>
Model loaded(const ModelFile& description, Network network) {
  const auto path = fs::temp_directory_path() / ("mien_seam_" + std::to_string(::getpid()) + ".safetensors");
  write_face_model(path, description, std::move(network));
  auto model = Model::load(path);
  EXPECT_TRUE(model) << model.error().message();
  fs::remove(path);
  return std::move(*model);
}

/// Twelve stretches of 0.3 to 1.2 s, two takes each: no join lies above the clip's 95th percentile.
template <class Model, class Options>
void expect_smooth_joins(const char* name, const Model& model, Options options) {
  const AudioClip clip = speech();
  Progress progress;
  const auto animated = animate(model, clip, options, 1, 1, progress);
  ASSERT_TRUE(animated) << animated.error().message();
  const Motion& motion = animated->front();
  std::vector<std::size_t> channels(static_cast<std::size_t>(motion.num_channels()));
  std::iota(channels.begin(), channels.end(), std::size_t{0});
  SeamMeasure measure(motion, channels);
  ASSERT_GT(measure.usual(), 0);
  const double fps = motion.fps;
  for (std::int64_t k = 0; k < 12; ++k) {
    const auto length = static_cast<std::int64_t>((0.3 + 0.08 * static_cast<double>(k)) * fps);
    const std::int64_t first = 5 + k * (motion.num_frames() - length - 10) / 12;
    const FrameRange stretch{first, first + length};
    KeptValues kept(motion);
    kept.keep_outside({&stretch, 1});
    options.seed = static_cast<std::uint64_t>(k);
    const auto takes = edit(model, clip, motion, kept, options, 2, 1, progress);
    ASSERT_TRUE(takes) << takes.error().message();
    for (const Motion& take : *takes) measure.add(take, stretch);
  }
  std::printf("%-20s at joins: median %.2f  p95 %.2f  largest %.2f  above 1: %ld of %ld\n", name,
              measure.ratio(0.5), measure.ratio(0.95), measure.ratio(1),
              static_cast<long>(measure.num_above()), static_cast<long>(measure.size()));
  EXPECT_EQ(measure.num_above(), 0);
}

TEST(EditPublishedSeams, OfSaidAreAsSmoothAsTheClip) {
  ModelFile m;
  m.architecture = Architecture::said;
  m.name = "small";
  m.encoder = small_face_encoder();
  m.output = {.space = "arkit", .channels = 32, .fps = 60, .topology = ""};
  m.diffusion = ModelDiffusion{"cosine", 1000};
  SaidOptions options;
  options.sampling.num_steps = 50;
  expect_smooth_joins(
      "SAiD",
      loaded<SaidModel>(
          m, said::Network<Tensor>({.width = 32, .context = 16, .time = 64, .inner = 64, .speech = 16})),
      options);
}

TEST(EditPublishedSeams, OfFaceDiffuserAreAsSmoothAsTheClip) {
  expect_smooth_joins("FaceDiffuser, mesh",
                      loaded<FaceModel>(face_description(Architecture::facediffuser_v),
                                        facediffuser::VertexDenoiser<Tensor>(small_mesh_sizes())),
                      FaceOptions{});
  expect_smooth_joins(
      "FaceDiffuser, rig",
      loaded<FaceModel>(face_description(Architecture::facediffuser_beat),
                        facediffuser::BeatDenoiser<Tensor>({.variant = facediffuser::Variant::beat,
                                                            .num_channels = 7,
                                                            .latent = 6,
                                                            .hidden = 6,
                                                            .num_steps = 12,
                                                            .condition = 32})),
      FaceOptions{});
}

}  // namespace
}  // namespace mien
