#include "mien/train/face_training.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>

#include "mien/train/optimiser.h"
#include "small_encoder_config.h"

namespace mien::train {
namespace {

namespace fs = std::filesystem;
constexpr std::int64_t kWidth = 6, kSubjects = 2;

EncoderConfig small_encoder() { return small_encoder_config(3); }

FaceNetwork network_with(FaceNetwork::Head head) {
  FaceNetwork network{SpeechEncoder<torch::Tensor>(small_encoder()), std::move(head), 25};
  initialise_as_published(network, 3);
  return network;
}

FaceNetwork regression(const DecoderSizes& decoder = {}) {
  return network_with(facexhubert::Network<torch::Tensor>({.input = 32,
                                                           .hidden = 12,
                                                           .decoder = decoder,
                                                           .num_subjects = kSubjects,
                                                           .num_emotions = 2,
                                                           .num_channels = kWidth}));
}

facediffuser::Sizes diffuser_sizes(facediffuser::Variant variant) {
  return {.variant = variant,
          .num_channels = kWidth,
          .latent = 12,
          .hidden = 12,
          .num_steps = 20,
          .condition = 32,
          .num_subjects = kSubjects};
}

struct VertexForm {
  DecoderSizes decoder = {};
  facediffuser::NoiseEncoder noise_encoder = facediffuser::NoiseEncoder::conv_max;
  bool has_diffusion = true;
};
FaceNetwork vertex_diffusion(const VertexForm& form = {}) {
  facediffuser::Sizes sizes = diffuser_sizes(facediffuser::Variant::vertices);
  sizes.decoder = form.decoder;
  sizes.noise_encoder = form.noise_encoder;
  if (!form.has_diffusion) sizes.num_steps = 0;
  return network_with(facediffuser::VertexDenoiser<torch::Tensor>(sizes));
}

// A tone that comes and goes; the face follows its loudness.
FaceSequence recording(std::size_t index) {
  FaceSequence s;
  s.name = "sequence " + std::to_string(index);
  const double beat = 9 + 2 * static_cast<double>(index);
  const auto loud = [&](double seconds) { return 0.5 + 0.5 * std::sin(beat * seconds); };
  for (int i = 0; i < 12000; ++i) {
    const double t = i / 16000.0;
    s.waveform.push_back(static_cast<float>(1.5 * loud(t) * std::sin(2000 * t)));
  }
  for (int n = 0; n < 19; ++n)  // one more than the 37 features make pairs of
    for (std::int64_t c = 0; c < kWidth; ++c)
      s.motion.push_back(static_cast<float>(0.3 + (c % 2 == 0 ? 0.5 : -0.5) * loud(n / 25.0)));
  s.neutral.assign(kWidth, 0.3f);
  s.style = one_hot_weights(static_cast<std::int64_t>(index) % kSubjects, kSubjects);
  return s;
}

FaceSequences recordings(std::size_t num_train, std::vector<std::string>* visited = nullptr) {
  return {num_train, 2, [visited](FaceSequences::Split split, std::size_t index) -> Result<FaceSequence> {
            auto s = recording(split == FaceSequences::Split::train ? index : index + 100);
            if (visited) visited->push_back(s.name);
            return s;
          }};
}

FaceTrainingOptions without_randomness() {
  return {.diffusion_steps = 20,
          .encoder_dropout = false,
          .layer_drop = false,
          .spec_augment = false,
          .decoder_dropout = 0};
}

class FaceTraining : public testing::Test {
 protected:
  void SetUp() override {
    torch::set_num_threads(1);
    folder_ = fs::path(testing::TempDir()) / ("mien_face_training_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Losses of all steps; first up to `stop_after`, when that is not 0, then to the end.
  std::vector<double> losses(FaceNetwork& network, const FaceTrainingOptions& options, std::int64_t num_steps,
                             std::int64_t stop_after, const std::string& name,
                             const std::vector<std::string>& frozen = published_frozen()) {
    std::vector<double> out;
    for (const bool first : {true, false}) {
      if (first && stop_after == 0) continue;
      const auto learning = freeze(parameters(network), frozen);
      EXPECT_TRUE(learning);
      FaceStage stage(network, recordings(3), options);
      Progress progress;
      const auto done = run_stage(
          name, *learning, StageOptions::plain_adam(num_steps, 1e-2), folder_ / (name + ".safetensors"),
          [&](std::int64_t step) { return stage.loss(step); }, progress,
          [&](const StepReport& r) {
            out.push_back(r.loss);
            if (first && r.step + 1 == stop_after) progress.cancel();
          });
      EXPECT_EQ(done.has_value(), !first);
    }
    return out;
  }
  fs::path folder_;
};

double mean(std::span<const double> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

TEST_F(FaceTraining, VerticesAreLearnt) {
  FaceNetwork network = regression();
  const auto l = losses(network, without_randomness(), 90, 0, "regression");
  EXPECT_LT(mean(std::span(l).last(9)), 0.5 * mean(std::span(l).first(9)));
}

TEST_F(FaceTraining, DiffusionIsLearnt) {
  FaceNetwork network = vertex_diffusion();
  const auto l = losses(network, without_randomness(), 120, 0, "diffusion");
  EXPECT_LT(mean(std::span(l).last(30)), 0.5 * mean(std::span(l).first(30)));
}

// The papers' other decoders, FaceDiffuser's other noise encoders, and no diffusion.
TEST_F(FaceTraining, EveryAblationIsLearnt) {
  const auto learns = [&](FaceNetwork network, const std::string& name, bool teacher_forcing = false) {
    FaceTrainingOptions options = without_randomness();
    options.teacher_forcing = teacher_forcing;
    const auto l = losses(network, options, 100, 0, name);
    EXPECT_LT(mean(std::span(l).last(20)), 0.7 * mean(std::span(l).first(20))) << name;
  };
  for (const DecoderKind kind : {DecoderKind::rnn, DecoderKind::lstm, DecoderKind::transformer}) {
    const DecoderSizes decoder{
        .kind = kind, .num_layers = kind == DecoderKind::transformer ? 1 : 2, .heads = 2};
    const std::string name(decoder_kind_name(kind));
    learns(regression(decoder), name + " regression");
    learns(vertex_diffusion({.decoder = decoder}), name + " diffusion");
  }
  learns(regression({.kind = DecoderKind::transformer, .num_layers = 1, .heads = 2}), "forced", true);
  using facediffuser::NoiseEncoder;
  for (const NoiseEncoder kind : {NoiseEncoder::conv_average, NoiseEncoder::mlp})
    learns(vertex_diffusion({.noise_encoder = kind}), std::string(noise_encoder_name(kind)));
  learns(vertex_diffusion({.has_diffusion = false}), "vertices without diffusion");
  auto rig = diffuser_sizes(facediffuser::Variant::beat);
  rig.num_steps = 0;
  learns(network_with(facediffuser::BeatDenoiser<torch::Tensor>(rig)), "B-BEAT without diffusion");
  rig.variant = facediffuser::Variant::damm;
  learns(network_with(facediffuser::DammDenoiser<torch::Tensor>(rig)), "B-DAMM without diffusion");
}

// Teacher forcing reads the recording, so what was written does not follow from the sound alone; validation
// never does.
TEST_F(FaceTraining, TeacherForcingReadsTheRecordingInTrainingAlone) {
  FaceNetwork network = regression({.kind = DecoderKind::transformer, .num_layers = 1, .heads = 2});
  std::get<facexhubert::Network<torch::Tensor>>(network.head).out.weight.detach().fill_(0.1);
  ASSERT_TRUE(freeze(parameters(network), published_frozen()));
  FaceTrainingOptions options = without_randomness();
  options.teacher_forcing = true;
  FaceStage stage(network, recordings(1), options);
  const torch::NoGradGuard no_grad;
  FaceSequence one = recording(0), other = recording(0);
  for (float& v : other.motion) v += 0.5f;
  Rng rng(1);
  const auto made = [&](const FaceSequence& s, Rng* random) { return stage.estimate(s, {}, random)->motion; };
  EXPECT_FALSE(torch::equal(made(one, &rng), made(other, &rng)));
  EXPECT_TRUE(torch::equal(made(one, nullptr), made(other, nullptr)));
}

// Everything random is on: what a step draws must follow from the step alone.
TEST_F(FaceTraining, GoesOnAfterAnInterruptionWithTheSameLosses) {
  FaceTrainingOptions options{.diffusion_steps = 20, .mask = AudioMask::partial_random};
  FaceNetwork whole = vertex_diffusion(), resumed = vertex_diffusion();
  const auto want = losses(whole, options, 14, 0, "whole");
  EXPECT_EQ(losses(resumed, options, 14, 6, "resumed"), want);
  FaceNetwork certain = vertex_diffusion();
  EXPECT_NE(losses(certain, without_randomness(), 14, 0, "certain"), want);
}

TEST_F(FaceTraining, KeptFeaturesGiveTheSameLosses) {
  FaceTrainingOptions options{.diffusion_steps = 20};
  FaceNetwork kept = vertex_diffusion(), again = vertex_diffusion();
  const auto want = losses(kept, options, 8, 0, "kept");
  options.cache_features = false;
  EXPECT_EQ(losses(again, options, 8, 0, "again"), want);
}

// Shares of curve and noise by a formula of the test's own (specification, section 3.2, cosine).
TEST_F(FaceTraining, ADiffusionIsShownTheNoiseOfItsStepAndToldTheStep) {
  constexpr int kSteps = 20;
  FaceNetwork network = vertex_diffusion();
  ASSERT_TRUE(freeze(parameters(network), published_frozen()));
  FaceTrainingOptions options = without_randomness();
  options.diffusion_steps = kSteps;
  FaceStage stage(network, recordings(1), options);
  const torch::NoGradGuard no_grad;
  torch::manual_seed(5);
  for (const auto& e : parameters(network))
    e.slot->add_(0.1 * torch::randn_like(*e.slot));  // its last layer is 0
  const FaceSequence sequence = recording(0);
  const torch::Tensor x0 = torch::tensor(sequence.motion).reshape({1, -1, kWidth}),
                      noise = torch::linspace(-2, 2, x0.numel()).reshape(x0.sizes());
  const auto share = [](double i) { return std::pow(std::cos((i / kSteps + 0.008) / 1.008 * M_PI / 2), 2); };
  double left = 1;
  std::vector<torch::Tensor> made;
  for (std::int64_t step = 0; step < kSteps; ++step) {
    left *= 1 - std::min(1 - share(static_cast<double>(step) + 1) / share(static_cast<double>(step)), 0.999);
    const torch::Tensor want = std::sqrt(left) * x0 + std::sqrt(1 - left) * noise;
    EXPECT_LT((stage.diffuse(x0, noise, step) - want).abs().max().item<double>(), 1e-5) << step;
    made.push_back(stage.estimate(sequence, {step, x0}, nullptr)->motion);
  }
  for (std::size_t step = 1; step < made.size(); ++step)
    EXPECT_FALSE(torch::equal(made[step], made[0])) << "the same curve at step " << step;
}

// A clip is known by its name, so other sound of the same name shows what is kept.
TEST_F(FaceTraining, AnEncoderThatIsFrozenHearsAClipOnce) {
  FaceNetwork network = regression();
  auto& encoder = network.encoder;
  for (const auto& e : parameters(encoder)) e.slot->requires_grad_(false);
  const auto one = recording(0).waveform, other = recording(1).waveform;
  const EncoderNoise none{false, false, false}, all{};
  constexpr auto kDevice = torch::kCPU;
  const auto twice = [&](const EncoderNoise& noise, bool keeps) {
    ClipEncoder clips(encoder, noise, kDevice, keeps);
    const torch::Tensor first = clips("a", one, nullptr);
    EXPECT_FALSE(torch::equal(first, clips("b", other, nullptr))) << "another clip";
    return torch::equal(first, clips("a", other, nullptr));
  };
  EXPECT_TRUE(twice(none, true));
  EXPECT_TRUE(twice(all, true)) << "the front";
  EXPECT_FALSE(twice(none, false));
  ClipEncoder random(encoder, all, kDevice, true), certain(encoder, none, kDevice, true);
  Rng draw(3);
  EXPECT_FALSE(torch::equal(random("a", one, &draw), random("a", one, &draw)))
      << "what is behind the front stays random";
  EXPECT_TRUE(torch::equal(certain("a", one, &draw), certain("a", one, nullptr)));
  encoder.layers[0].output_dense.weight.requires_grad_(true);
  ClipEncoder learning(encoder, none, kDevice, true);
  const torch::Tensor before = learning("a", one, nullptr).detach();
  {
    const torch::NoGradGuard no_grad;
    encoder.layers[0].output_dense.weight.mul_(1.5);
  }
  EXPECT_FALSE(torch::equal(before, learning("a", one, nullptr))) << "a layer that learns is not kept";
  encoder.layers[0].output_dense.weight.requires_grad_(false);
  for (const auto& e : parameters(encoder)) e.slot->requires_grad_(true);
  EXPECT_FALSE(twice(none, true)) << "the convolutions learn";
}

// An encoder that is frozen and not random is heard once.
TEST_F(FaceTraining, KeptOutputOfTheEncoderGivesTheSameLosses) {
  FaceTrainingOptions options = without_randomness();
  options.diffusion_steps = 20;
  options.decoder_dropout = 0.3;
  FaceNetwork kept = vertex_diffusion(), again = vertex_diffusion();
  const auto want = losses(kept, options, 8, 0, "kept", {"audio_encoder"});
  options.cache_features = false;
  EXPECT_EQ(losses(again, options, 8, 0, "again", {"audio_encoder"}), want);
}

TEST_F(FaceTraining, FrozenParametersStayAndTheOthersMove) {
  FaceNetwork network = regression();
  std::map<std::string, torch::Tensor> before;
  for (const auto& e : parameters(network)) before[e.name] = e.slot->detach().clone();
  losses(network, {}, 12, 0, "frozen");
  for (const auto& e : parameters(network)) {
    if (e.name.ends_with("k_proj.bias")) continue;  // adds the same to all scores: no gradient but rounding
    const bool frozen = e.name.find("feature_") != std::string::npos ||
                        e.name.find(".layers.0.") != std::string::npos ||
                        e.name.find(".layers.1.") != std::string::npos;
    EXPECT_EQ(torch::equal(*e.slot, before.at(e.name)), frozen) << e.name;
  }
}

TEST_F(FaceTraining, RefusesToFreezeNothingOrEverything) {
  FaceNetwork network = regression();
  const auto unknown = freeze(parameters(network), {"audio_encoder.layers.0"});
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message().find("audio_encoder.layers.0"), std::string::npos);
  EXPECT_FALSE(freeze(parameters(network), {"audio_encoder", "gru", "obj_vector", "emo_vector", "fc"}));
  EXPECT_EQ(freeze(parameters(network), {"audio_encoder"})->size(), 8u + 4u);
}

TEST_F(FaceTraining, AnEpochVisitsEverySequenceOnce) {
  FaceNetwork network = regression();
  ASSERT_TRUE(freeze(parameters(network), published_frozen()));
  std::vector<std::string> visited;
  FaceStage stage(network, recordings(7, &visited), without_randomness());
  const torch::NoGradGuard no_grad;
  for (std::int64_t step = 0; step < 14; ++step) ASSERT_TRUE(stage.loss(step));
  const std::vector<std::string> first(visited.begin(), visited.begin() + 7),
      second(visited.begin() + 7, visited.end());
  EXPECT_EQ(std::set<std::string>(first.begin(), first.end()).size(), 7u);
  EXPECT_EQ(std::set<std::string>(second.begin(), second.end()).size(), 7u);
  EXPECT_NE(first, second);
  const auto valid = stage.validation_loss(0);
  ASSERT_TRUE(valid);
  EXPECT_GT(*valid, 0);
  EXPECT_EQ(*valid, *stage.validation_loss(0));
}

TEST_F(FaceTraining, MasksTheAskedShareOfTheSound) {
  FaceNetwork network = regression();
  const torch::NoGradGuard no_grad;
  FaceSequence s = recording(0);
  FaceTrainingOptions options = without_randomness();
  const auto covered = [&](AudioMask mask, Rng& rng) {
    options.mask = mask;
    FaceStage stage(network, {}, options);
    const auto plain = stage.estimate(s, {}, nullptr), random = stage.estimate(s, {}, &rng);
    return (plain->speech != random->speech).all(-1).to(torch::kFloat).mean().item<double>();
  };
  for (const auto mask : {AudioMask::partial_zero, AudioMask::partial_random}) {
    Rng rng(4);
    double sum = 0;
    for (int i = 0; i < 60; ++i) sum += covered(mask, rng);
    EXPECT_NEAR(sum / 60, 0.25, 0.06);  // of 1080 frames: 4.5 standard deviations
  }
  for (const auto mask : {AudioMask::full_zero, AudioMask::full_random}) {
    Rng rng(4);
    int whole = 0;
    for (int i = 0; i < 60; ++i) {
      const double part = covered(mask, rng);
      EXPECT_TRUE(part == 0 || part == 1) << part;
      whole += part == 1 ? 1 : 0;
    }
    EXPECT_NEAR(whole, 15, 14);
    EXPECT_GT(whole, 0);
  }
}

TEST_F(FaceTraining, NamesSequencesThatNothingCanBeLearntFrom) {
  FaceNetwork network = regression();
  FaceStage stage(network, {}, without_randomness());
  const auto why = [&](const FaceSequence& s) {
    const auto made = stage.estimate(s, {}, nullptr);
    return made ? std::string() : made.error().message();
  };
  FaceSequence no_sound = recording(0), no_motion = recording(0), odd = recording(0), neutral = recording(0);
  no_sound.waveform.resize(500);
  no_motion.motion.clear();
  odd.motion.pop_back();
  neutral.neutral.pop_back();
  for (const auto& s : {no_sound, no_motion, odd, neutral})
    EXPECT_NE(why(s).find("sequence 0"), std::string::npos) << why(s);
  EXPECT_EQ(why(recording(0)), "");
}

TEST_F(FaceTraining, StartsAsThePublishedProgramsDo) {
  FaceNetwork mesh = vertex_diffusion();
  auto& v = std::get<facediffuser::VertexDenoiser<torch::Tensor>>(mesh.head);
  EXPECT_EQ(v.out.weight.abs().max().item<float>(), 0);
  EXPECT_EQ(v.out.bias.abs().max().item<float>(), 0);
  EXPECT_NEAR(v.decoder.gru().layers[0].b_hh.abs().max().item<double>(), 1 / std::sqrt(12.0), 0.05);
  EXPECT_NEAR(v.speech.bias.abs().max().item<double>(), 1 / std::sqrt(32.0), 0.05);
  EXPECT_NEAR(v.styles.table.abs().max().item<double>(), 1 / std::sqrt(2.0), 0.15);

  FaceNetwork rig =
      network_with(facediffuser::DammDenoiser<torch::Tensor>(diffuser_sizes(facediffuser::Variant::damm)));
  auto& d = std::get<facediffuser::DammDenoiser<torch::Tensor>>(rig.head);
  EXPECT_NEAR(d.out.weight.std().item<double>(), 1, 0.3);
  EXPECT_FLOAT_EQ(d.sinusoids[3][0][0].item<float>(), std::sin(3.0f));
  EXPECT_NEAR(d.sinusoids[3][0][5].item<double>(), std::cos(3 * std::pow(10000.0, -4.0 / 12)), 1e-6);
}

}  // namespace
}  // namespace mien::train
