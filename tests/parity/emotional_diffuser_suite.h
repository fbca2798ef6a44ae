#pragma once
// ProbTalk3D's emotional form of FaceDiffuser on a tensor library: one recorded pass, and walks with recorded
// noise, plainly and, on the runtime, frame by frame in the latent.
#include <gtest/gtest.h>

#include <type_traits>

#include "closeness.h"
#include "emotional_case.h"
#include "mien/models/facediffuser/frame_diffusion.h"

namespace mien::parity {

template <class T>
class EmotionalFaceDiffuser : public testing::Test {
 protected:
  using Case = EmotionalCase<T>;
  using Walk = facediffuser::Walk;

  template <class Body>
  static void for_each_emotional(Body&& body) {
    for_each_case("probtalk3d", "", Case::kSampling, [&](const std::string& name) { body(Case(name)); });
  }

  // Plainly with every state that was recorded, and in the latent, which must end at the same.
  static void expect_walk(const Case& c, const Walk& walk, const std::string& group,
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
        [&](const Tensor& x_t, std::int64_t step) { return c.predict_x0(x_t, step); },
        Operations<T>::num_rows(c.given.speech), c.network.sizes.num_channels, c.process, walk, noise,
        [&](int step, const Tensor& x_t, const Tensor& x0) {
          const auto name = [&](std::int64_t t) {
            return std::string("mid.").append(group).append(".t").append(std::to_string(t));
          };
          expect(x_t, name(first - step) + ".x_in");
          expect(x_t, name(first - step + 1) + ".x_out");
          expect(x0, name(first - step) + ".pred_x0");
        });
    expect(walked, result);
    EXPECT_GT(num_compared, 5);
    if constexpr (std::is_same_v<T, Tensor>) {
      SCOPED_TRACE("frame by frame");
      const auto folded = std::make_shared<const facediffuser::FoldedDenoiser>(
          facediffuser::fold(std::make_shared<const facediffuser::VertexDenoiser<Tensor>>(c.network)));
      facediffuser::FrameDiffusion fast(folded, c.process, walk,
                                        {{c.given.style, c.given.neutral, &noise, true}}, 2);
      MIEN_EXPECT_CLOSE(fast.next({&c.aligned_speech, 1}).front(), f.tensor(result), "ddim walk");
    }
  }

  // x after the step from index t of the process.
  static Tensor stepped(const Case& c, SamplerKind kind, std::int64_t t, Tensor x, std::span<const float> z,
                        const std::string& estimate = "") {
    const Tensor x0 = c.predict_x0(x, t);
    if (!estimate.empty()) {
      MIEN_EXPECT_CLOSE(x0, c.sampling.tensor(estimate), "walk");
    }
    const auto levels = c.process.sampling_levels(c.process.size() - 1 - t);
    plan_sampling({.kind = kind}, levels).front().apply(x.values(), x0.values(), x0.values(), z);
    return x;
  }
};
TYPED_TEST_SUITE_P(EmotionalFaceDiffuser);

TYPED_TEST_P(EmotionalFaceDiffuser, GivesTheRecordedStages) {
  using T = TypeParam;
  TestFixture::for_each_emotional([](const EmotionalCase<T>& c) {
    const auto expect = [&](const Tensor& got, const char* name) {
      SCOPED_TRACE(name);
      MIEN_EXPECT_CLOSE(as_row(got), as_row(c.forward.tensor(name)), "stage");
    };
    const auto expect_stage = [&](const T& got, const char* name) { expect(Backend<T>::values(got), name); };
    EXPECT_TRUE(c.network.sizes.styles_speech) << "told from V by its shapes";
    const std::int64_t t = c.forward.integers("in.t").at(0);
    const NoiseLevel level = c.process.level(t);
    expect(add(scale(c.forward.tensor("in.x0"), static_cast<float>(level.alpha)),
               scale(c.forward.tensor("in.noise"), static_cast<float>(level.sigma))),
           "mid.x_t");
    const T x_t = Backend<T>::given(c.forward.tensor("mid.x_t"));
    expect_stage(c.aligned_speech, "mid.audio_paired");
    expect_stage(c.given.style, "mid.style_embedding");
    expect_stage(c.given.speech, "mid.cond_projection");
    const T linear = c.network.noise.map(x_t);
    expect_stage(linear, "mid.input_linear");
    expect_stage(c.network.noise.filter(linear), "mid.input_conv");
    expect_stage(c.network.noise(x_t), "mid.input_projection");
    expect_stage(c.network.time_token(x_t, t), "mid.time_mlp");
    const T tokens = c.network.tokens(x_t, c.given, t), states = c.network.decoder.states(tokens);
    expect_stage(tokens, "mid.norm_cond");
    expect_stage(states, "mid.gru");
    expect_stage(c.network.out(states), "mid.final_layer");
    expect_stage(c.network.predict_x0(x_t, c.given, t), "out.pred_x0");
  });
}

TYPED_TEST_P(EmotionalFaceDiffuser, DdimEndsAsRecorded) {
  TestFixture::for_each_emotional([](const auto& c) {
    const facediffuser::Walk walk{.sampler = {.kind = SamplerKind::ddim},
                                  .skip = std::stoll(c.sampling.metadata("skip_timesteps"))};
    TestFixture::expect_walk(c, walk, "ddim", RecordedNoise(c.sampling, "in.noise_start", "no noise"),
                             "out.ddim");
  });
}

TYPED_TEST_P(EmotionalFaceDiffuser, AncestralStepsEndAsRecorded) {
  TestFixture::for_each_emotional([](const auto& c) {
    const facediffuser::Walk walk{.sampler = {.kind = SamplerKind::ancestral},
                                  .skip = c.process.size() - std::stoll(c.sampling.metadata("ddpm_steps"))};
    TestFixture::expect_walk(
        c, walk, "ddpm", RecordedNoise(c.sampling, "in.ddpm.noise_start", "in.ddpm.noise_steps"), "out.ddpm");
  });
}

TYPED_TEST_P(EmotionalFaceDiffuser, SingleStepsEndAsRecorded) {
  TestFixture::for_each_emotional([](const auto& c) {
    const Fixture& f = c.sampling;
    int num_steps = 0;
    for (std::int64_t t = 0; t < c.process.size(); ++t) {
      const std::string step = numbered("t", t);
      if (!f.has("in.single." + step + ".x")) continue;
      SCOPED_TRACE(step);
      MIEN_EXPECT_CLOSE(TestFixture::stepped(c, SamplerKind::ddim, t, f.tensor("in.single." + step + ".x"),
                                             {}, "out.single.pred_x0." + step),
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
      x = TestFixture::stepped(c, SamplerKind::ancestral, c.process.size() - 1 - i, std::move(x), z.values());
    }
    MIEN_EXPECT_CLOSE(x, f.tensor(numbered("out.ddpm_top.after_t", last)), "walk");
  });
}

TYPED_TEST_P(EmotionalFaceDiffuser, HasTheRecordedSchedule) {
  TestFixture::for_each_emotional([](const auto& c) {
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

REGISTER_TYPED_TEST_SUITE_P(EmotionalFaceDiffuser, GivesTheRecordedStages, DdimEndsAsRecorded,
                            AncestralStepsEndAsRecorded, SingleStepsEndAsRecorded, HasTheRecordedSchedule);

}  // namespace mien::parity
