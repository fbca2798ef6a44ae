#pragma once
// FaceDiffuser on a tensor library: single calls of the denoisers and whole walks with recorded noise.
#include <gtest/gtest.h>

#include <type_traits>

#include "closeness.h"
#include "face_weights.h"
#include "mien/models/facediffuser/frame_diffusion.h"

namespace mien::parity {

template <class T>
class FaceDiffuser : public testing::Test {
 protected:
  using Case = DiffuserCase<T>;
  using Walk = facediffuser::Walk;

  template <class Body>
  static void for_each_diffuser(const char* stage, Body&& body) {
    for_each_case("facediffuser", "", std::string(".") + stage + ".safetensors", body);
  }

  /// Every stage that was recorded for step t.0, by the names of the published modules.
  static void expect_stages(const Case& c, const Tensor& recorded_x_t, std::int64_t step) {
    const Fixture& f = c.forward;
    const T x_t = Backend<T>::given(recorded_x_t);
    const auto expect = [&](const T& got, const char* name) {
      SCOPED_TRACE(name);
      MIEN_EXPECT_CLOSE(as_row(Backend<T>::values(got)), as_row(f.tensor(name)), "stage");
    };
    std::visit(
        [&](const auto& n) {
          const T tokens = n.tokens(x_t, c.given, step);
          const T states = n.decoder.states(tokens);
          if (f.has("norm_cond")) expect(tokens, "norm_cond");
          if (f.has("gru")) expect(states, "gru");
          if (f.has("rnn")) expect(states, "rnn");
          if (f.has("time_mlp")) expect(n.time_token(x_t, step), "time_mlp");
        },
        c.network);
    if (const auto* v = c.vertices()) {
      const T linear = v->noise.map(x_t);
      expect(linear, "noise_enc.linear");
      expect(v->noise.filter(linear), "noise_enc.conv");
      expect(v->noise(x_t), "noise_enc.out");
      expect(c.given.speech, "cond_projection");
      expect(c.given.style, "style_vector");
    }
  }

  /// The runtime's fast path ends as the plain one.
  static void expect_fast_walk(const Case& c, const FrameNoise& noise, const DiffusionProcess& process,
                               const Walk& walk, const Tensor& final) {
    if constexpr (std::is_same_v<T, Tensor>) {
      if (c.vertices() != nullptr && walk.sampler.clip_x0) return;
      SCOPED_TRACE("frame by frame");
      const auto folded = std::visit(
          [](const auto& n) {
            using Network = std::decay_t<decltype(n)>;
            return std::make_shared<const facediffuser::FoldedDenoiser>(
                facediffuser::fold(std::make_shared<const Network>(n)));
          },
          c.network);
      const facediffuser::Lane lane{c.given.style, c.given.neutral, &noise, true};
      facediffuser::FrameDiffusion fast(folded, process, walk, {lane});
      MIEN_EXPECT_CLOSE(fast.next({&c.aligned_speech, 1}).front(), final, "walk");
    }
  }

  /// Walks and compares each state and estimate that was recorded, and the result.
  static void expect_walk(const Case& c, const Fixture& recorded, const std::string& group,
                          const std::string& initial, const std::string& steps,
                          const DiffusionProcess& process, const Walk& walk) {
    SCOPED_TRACE(group.empty() ? "walk" : group);
    const RecordedNoise noise(recorded, group + initial, group + steps);
    const auto expect = [&](const Tensor& got, const std::string& tensor) {
      if (!recorded.has(group + tensor)) return;
      SCOPED_TRACE(tensor);
      MIEN_EXPECT_CLOSE(got, recorded.tensor(group + tensor), "walk");
    };
    const Tensor result = facediffuser::sample_plainly(
        [&](const Tensor& x_t, std::int64_t step) { return c.predict_x0(x_t, step); }, c.num_frames(),
        c.num_channels, process, walk, noise,
        [&](int step, const Tensor& x_t, const Tensor& x0) {
          if (step > 0) expect(x_t, numbered("sample_after.", step - 1));
          expect(x0, numbered("pred_xstart.", step));
        });
    expect(result, numbered("sample_after.", process.size() - walk.skip - 1));
    expect(result, "final");
    expect_fast_walk(c, noise, process, walk, recorded.tensor(group + "final"));
  }

  static DiffusionProcess whole_process(const Case& c, BetaSchedule schedule = BetaSchedule::cosine) {
    return DiffusionProcess(betas_of(schedule, c.num_steps));
  }
  /// Steps of a recorded walk: one noise each.
  static std::int64_t num_walked(const Fixture& recorded, const std::string& noise) {
    return recorded.file().find(noise)->shape.at(0);
  }
  /// The number in a metadata text such as "0.5 for ddim_eta" or "skip_timesteps=2".
  static double number_in(const std::string& text) {
    return std::stod(text.substr(text.find_first_of("0123456789")));
  }
};
TYPED_TEST_SUITE_P(FaceDiffuser);

TYPED_TEST_P(FaceDiffuser, DenoisersGiveTheRecordedEstimates) {
  this->for_each_diffuser("forward", [](const std::string& name) {
    const DiffuserCase<TypeParam> c(name);
    const Tensor x_t = c.forward.tensor("x_t");
    for (int j = 0; c.forward.has(numbered("t.", j)); ++j) {
      const std::int64_t step = c.forward.integers(numbered("t.", j)).at(0);
      SCOPED_TRACE(numbered("t = ", step));
      MIEN_EXPECT_CLOSE(c.predict_x0(x_t, step), c.forward.tensor(numbered("out.", j)), "estimate");
      if (j == 0) TestFixture::expect_stages(c, x_t, step);
    }
  });
}

TYPED_TEST_P(FaceDiffuser, SpeechIsAlignedAsRecorded) {
  this->for_each_diffuser("forward", [](const std::string& name) {
    const DiffuserCase<TypeParam> c(name);
    EXPECT_EQ(num_diffuser_frames(c.open("inputs").tensor("audio").count(), c.fps),
              c.forward.tensor("x_t").num_rows());
    EXPECT_EQ(c.num_frames(), c.forward.tensor("x_t").num_rows());
  });
}

TYPED_TEST_P(FaceDiffuser, AncestralWalksEndAsRecorded) {
  this->for_each_diffuser("psample", [](const std::string& name) {
    const DiffuserCase<TypeParam> c(name);
    TestFixture::expect_walk(c, c.open("psample"), "", "x_T", "noise", TestFixture::whole_process(c), {});
  });
}

TYPED_TEST_P(FaceDiffuser, WalksThatLeaveOutStepsEndAsRecorded) {
  this->for_each_diffuser("psample_skip", [](const std::string& name) {
    const DiffuserCase<TypeParam> c(name);
    const Fixture recorded = c.open("psample_skip");
    TestFixture::expect_walk(c, recorded, "", "initial_noise", "noise", TestFixture::whole_process(c),
                             {.skip = c.num_steps - TestFixture::num_walked(recorded, "noise")});
  });
}

TYPED_TEST_P(FaceDiffuser, LinearScheduleAndClippingEndAsRecorded) {
  this->for_each_diffuser("psample_variants", [](const std::string& name) {
    const DiffuserCase<TypeParam> c(name);
    const Fixture recorded = c.open("psample_variants");
    TestFixture::expect_walk(c, recorded, "", "initial_noise", "noise",
                             TestFixture::whole_process(c, BetaSchedule::linear),
                             {.skip = c.num_steps - TestFixture::num_walked(recorded, "noise")});
    facediffuser::Walk clipped{.skip = c.num_steps - TestFixture::num_walked(recorded, "clip.noise")};
    clipped.sampler.clip_x0 = {.low = 0, .high = 1};
    TestFixture::expect_walk(c, recorded, "clip.", "initial_noise", "noise", TestFixture::whole_process(c),
                             clipped);
  });
}

TYPED_TEST_P(FaceDiffuser, DdimAndRespacedWalksEndAsRecorded) {
  this->for_each_diffuser("ddim", [](const std::string& name) {
    const DiffuserCase<TypeParam> c(name);
    const Fixture recorded = c.open("ddim");
    const SamplerKind ddim = SamplerKind::ddim;
    const double eta = TestFixture::number_in(recorded.metadata("eta"));
    const auto skip = static_cast<std::int64_t>(TestFixture::number_in(recorded.metadata("ddim_skip")));
    const std::pair<std::string, facediffuser::Walk> groups[] = {
        {"ddim_eta0.", {.sampler = {.kind = ddim}}},
        {"ddim_eta.", {.sampler = {.kind = ddim, .eta = eta}}},
        {"respaced_psample.", {}},
        {"ddim_skip.", {.sampler = {.kind = ddim}, .skip = skip}}};
    for (const auto& [group, walk] : groups) {
      const auto kept = recorded.integers(group + "timestep_map");
      const DiffusionProcess process = TestFixture::whole_process(c).respaced(kept);
      MIEN_EXPECT_CLOSE(process.betas(), recorded.doubles(group + "betas"), "schedule");
      TestFixture::expect_walk(c, recorded, group, "initial_noise", "noise", process, walk);
    }
  });
}

REGISTER_TYPED_TEST_SUITE_P(FaceDiffuser, DenoisersGiveTheRecordedEstimates, SpeechIsAlignedAsRecorded,
                            AncestralWalksEndAsRecorded, WalksThatLeaveOutStepsEndAsRecorded,
                            LinearScheduleAndClippingEndAsRecorded, DdimAndRespacedWalksEndAsRecorded);

}  // namespace mien::parity
