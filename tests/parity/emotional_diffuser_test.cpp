// ProbTalk3D's emotional form of FaceDiffuser: one recorded pass, and walks with recorded noise, plainly and
// frame by frame in the latent.
#include <gtest/gtest.h>

#include "closeness.h"
#include "face_weights.h"
#include "mien/models/alignment.h"
#include "mien/models/facediffuser/frame_diffusion.h"
#include "recorded_weights.h"

namespace mien::parity {
namespace {

using facediffuser::VertexDenoiser;
using facediffuser::Walk;

constexpr std::string_view kSampling = "_sampling.safetensors";
constexpr double kFps = 25;

Tensor as_row(const Tensor& x) { return x.reshaped({1, x.count()}); }

/// A recorded network with its conditions.
struct EmotionalCase {
  explicit EmotionalCase(const std::string& name)
      : forward("probtalk3d", name + ".safetensors"),
        sampling("probtalk3d", name + std::string(kSampling)),
        network(recorded_network<Tensor>(forward, VertexDenoiser<Tensor>(sizes(forward)))),
        process(betas_of(BetaSchedule::cosine, network.sizes.num_steps)) {
    const Tensor features = forward.tensor("mid.audio_last_hidden");
    const std::int64_t num_frames = std::stoll(forward.metadata("num_frames"));
    aligned_speech = aligned(features, align_features(features.num_rows(), num_frames, kFps));
    given.speech = network.speech_tokens(aligned_speech);
    given.style = network.style(as_row(forward.tensor("in.style_onehot")));
    given.neutral = as_row(forward.tensor("in.template"));
  }
  static facediffuser::Sizes sizes(const Fixture& weights) {
    const auto found = facediffuser::sizes_of(weights.file());
    if (!found) throw std::runtime_error(found.error().message());
    return *found;
  }
  Fixture forward, sampling;
  VertexDenoiser<Tensor> network;
  DiffusionProcess process;
  Tensor aligned_speech;
  facediffuser::Conditions<Tensor> given;
};

void for_each_emotional(void (*body)(const EmotionalCase&)) {
  for_each_case("probtalk3d", "", kSampling, [&](const std::string& name) { body(EmotionalCase(name)); });
}

TEST(EmotionalFaceDiffuser, GivesTheRecordedStages) {
  for_each_emotional([](const EmotionalCase& c) {
    const auto expect = [&](const Tensor& got, const char* name) {
      SCOPED_TRACE(name);
      const Tensor want = c.forward.tensor(name);
      MIEN_EXPECT_CLOSE(as_row(got), as_row(want), "stage");
    };
    EXPECT_TRUE(c.network.sizes.styles_speech) << "told from V by its shapes";
    const std::int64_t t = c.forward.integers("in.t").at(0);
    const NoiseLevel level = c.process.level(t);
    const Tensor x_t = c.forward.tensor("mid.x_t");
    expect(add(scale(c.forward.tensor("in.x0"), static_cast<float>(level.alpha)),
               scale(c.forward.tensor("in.noise"), static_cast<float>(level.sigma))),
           "mid.x_t");
    expect(c.aligned_speech, "mid.audio_paired");
    expect(c.given.style, "mid.style_embedding");
    expect(c.given.speech, "mid.cond_projection");
    const Tensor linear = c.network.noise_in(x_t);
    expect(linear, "mid.input_linear");
    expect(c.network.noise_filter(linear), "mid.input_conv");
    expect(c.network.noise_tokens(x_t), "mid.input_projection");
    expect(c.network.time_token(x_t, t), "mid.time_mlp");
    const Tensor tokens = c.network.tokens(x_t, c.given, t);
    expect(tokens, "mid.norm_cond");
    expect(c.network.gru(tokens), "mid.gru");
    expect(c.network.out(c.network.gru(tokens)), "mid.final_layer");
    expect(c.network.predict_x0(x_t, c.given, t), "out.pred_x0");
  });
}

// Plainly with every state that was recorded, and in the latent, which must end at the same.
void expect_walk(const EmotionalCase& c, const Walk& walk, const std::string& group,
                 const RecordedNoise& noise, const std::string& result) {
  SCOPED_TRACE(group);
  const Fixture& f = c.sampling;
  int num_compared = 0;
  const auto expect = [&](const Tensor& got, const std::string& name) {
    if (!f.has(name)) return;
    SCOPED_TRACE(name);
    MIEN_EXPECT_CLOSE(got, f.tensor(name), "ddim walk");
    ++num_compared;
  };
  const std::int64_t first = c.process.size() - 1 - walk.skip;
  const Tensor walked = facediffuser::sample_plainly(
      c.network, c.given, c.process, walk, noise, [&](int step, const Tensor& x_t, const Tensor& x0) {
        const auto name = [&](std::int64_t t) { return "mid." + group + ".t" + std::to_string(t); };
        expect(x_t, name(first - step) + ".x_in");
        expect(x_t, name(first - step + 1) + ".x_out");
        expect(x0, name(first - step) + ".pred_x0");
      });
  expect(walked, result);
  EXPECT_GT(num_compared, 5);
  const auto folded = std::make_shared<const facediffuser::FoldedDenoiser>(
      facediffuser::fold(std::make_shared<const VertexDenoiser<Tensor>>(c.network)));
  facediffuser::FrameDiffusion fast(folded, c.process, walk, {{c.given.style, c.given.neutral, &noise, true}},
                                    2);
  MIEN_EXPECT_CLOSE(fast.next({&c.aligned_speech, 1}).front(), f.tensor(result), "ddim walk");
}

TEST(EmotionalFaceDiffuser, DdimEndsAsRecorded) {
  for_each_emotional([](const EmotionalCase& c) {
    const Walk walk{.sampler = {.kind = SamplerKind::ddim},
                    .skip = std::stoll(c.sampling.metadata("skip_timesteps"))};
    expect_walk(c, walk, "ddim", RecordedNoise(c.sampling, "in.noise_start", "no noise"), "out.ddim");
  });
}

TEST(EmotionalFaceDiffuser, AncestralStepsEndAsRecorded) {
  for_each_emotional([](const EmotionalCase& c) {
    const Walk walk{.sampler = {.kind = SamplerKind::ancestral},
                    .skip = c.process.size() - std::stoll(c.sampling.metadata("ddpm_steps"))};
    expect_walk(c, walk, "ddpm", RecordedNoise(c.sampling, "in.ddpm.noise_start", "in.ddpm.noise_steps"),
                "out.ddpm");
  });
}

// x after the step from index t of the process.
Tensor stepped(const EmotionalCase& c, SamplerKind kind, std::int64_t t, Tensor x, std::span<const float> z,
               const std::string& estimate = "") {
  const Tensor x0 = c.network.predict_x0(x, c.given, t);
  if (!estimate.empty()) {
    MIEN_EXPECT_CLOSE(x0, c.sampling.tensor(estimate), "walk");
  }
  const auto levels = c.process.sampling_levels(c.process.size() - 1 - t);
  plan_sampling({.kind = kind}, levels).front().apply(x.values(), x0.values(), x0.values(), z);
  return x;
}

TEST(EmotionalFaceDiffuser, SingleStepsEndAsRecorded) {
  for_each_emotional([](const EmotionalCase& c) {
    const Fixture& f = c.sampling;
    int num_steps = 0;
    for (std::int64_t t = 0; t < c.process.size(); ++t) {
      const std::string step = "t" + std::to_string(t);
      if (!f.has("in.single." + step + ".x")) continue;
      SCOPED_TRACE(step);
      MIEN_EXPECT_CLOSE(stepped(c, SamplerKind::ddim, t, f.tensor("in.single." + step + ".x"), {},
                                "out.single.pred_x0." + step),
                        f.tensor("out.single_ddim." + step), "walk");
      ++num_steps;
    }
    EXPECT_GT(num_steps, 0);
    // The first steps from pure noise.
    Tensor x = f.tensor("in.ddpm_top.noise_start");
    const std::int64_t num_top = f.file().find("in.ddpm_top.noise_steps")->shape.at(0),
                       last = c.process.size() - num_top;
    for (std::int64_t i = 0; i < num_top; ++i) {
      const Tensor z = f.slice("in.ddpm_top.noise_steps", i);
      x = stepped(c, SamplerKind::ancestral, c.process.size() - 1 - i, std::move(x), z.values());
    }
    MIEN_EXPECT_CLOSE(x, f.tensor("out.ddpm_top.after_t" + std::to_string(last)), "walk");
  });
}

TEST(EmotionalFaceDiffuser, HasTheRecordedSchedule) {
  for_each_emotional([](const EmotionalCase& c) {
    const auto expect = [&](const char* array, auto&& value_at) {
      std::vector<double> values;
      for (std::int64_t i = 0; i < c.process.size(); ++i) values.push_back(value_at(i));
      SCOPED_TRACE(array);
      MIEN_EXPECT_CLOSE(values, c.sampling.doubles(array), "schedule");
    };
    expect("schedule.betas", [&](std::int64_t i) { return c.process.betas()[static_cast<std::size_t>(i)]; });
    expect("schedule.alphas_cumprod", [&](std::int64_t i) { return c.process.alpha_bar(i); });
    expect("schedule.posterior_variance", [&](std::int64_t i) { return c.process.posterior_variance(i); });
    expect("schedule.posterior_log_variance_clipped",
           [&](std::int64_t i) { return c.process.posterior_log_variance(i); });
    expect("schedule.posterior_mean_coef1", [&](std::int64_t i) { return c.process.posterior_x0_weight(i); });
    expect("schedule.posterior_mean_coef2", [&](std::int64_t i) { return c.process.posterior_x_weight(i); });
  });
}

}  // namespace
}  // namespace mien::parity
