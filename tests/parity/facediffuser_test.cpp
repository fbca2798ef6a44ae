// FaceDiffuser: single calls of the denoisers and whole walks with recorded noise.
#include <gtest/gtest.h>

#include "closeness.h"
#include "face_weights.h"
#include "mien/models/alignment.h"
#include "mien/models/facediffuser/frame_diffusion.h"

namespace mien::parity {
namespace {

using facediffuser::Walk;

void for_each_diffuser(const char* stage, void (*body)(const std::string&)) {
  for_each_case("facediffuser", "", std::string(".") + stage + ".safetensors", body);
}

Tensor flat(const Tensor& x) { return x.reshaped({x.count()}); }

// Every stage that was recorded for step t.0, by the names of the published modules.
void expect_stages(const DiffuserCase& c, const Tensor& x_t, std::int64_t step) {
  const Fixture& f = c.forward;
  const auto expect = [&](const Tensor& got, const char* name) {
    SCOPED_TRACE(name);
    MIEN_EXPECT_CLOSE(flat(got), flat(f.tensor(name)), "stage");
  };
  std::visit(
      [&](const auto& n) {
        const Tensor tokens = n.tokens(x_t, c.given, step);
        const Tensor states = n.gru(tokens);
        if (f.has("norm_cond")) expect(tokens, "norm_cond");
        if (f.has("gru")) expect(states, "gru");
        if (f.has("rnn")) expect(states, "rnn");
        if (f.has("time_mlp")) expect(n.time_token(x_t, step), "time_mlp");
      },
      c.network);
  if (const auto* v = std::get_if<facediffuser::VertexDenoiser<Tensor>>(&c.network)) {
    const Tensor linear = v->noise_in(x_t);
    expect(linear, "noise_enc.linear");
    expect(v->noise_filter(linear), "noise_enc.conv");
    expect(v->noise_tokens(x_t), "noise_enc.out");
    expect(c.given.speech, "cond_projection");
    expect(c.given.style, "style_vector");
  }
}

TEST(FaceDiffuser, DenoisersGiveTheRecordedEstimates) {
  for_each_diffuser("forward", [](const std::string& name) {
    const DiffuserCase c(name);
    const Tensor x_t = c.forward.tensor("x_t");
    for (int j = 0; c.forward.has("t." + std::to_string(j)); ++j) {
      const std::int64_t step = c.forward.integers("t." + std::to_string(j)).at(0);
      SCOPED_TRACE("t = " + std::to_string(step));
      MIEN_EXPECT_CLOSE(c.predict_x0(x_t, step), c.forward.tensor("out." + std::to_string(j)), "estimate");
      if (j == 0) expect_stages(c, x_t, step);
    }
  });
}

TEST(FaceDiffuser, SpeechIsAlignedAsRecorded) {
  for_each_diffuser("forward", [](const std::string& name) {
    const DiffuserCase c(name);
    const Fixture inputs = c.open("inputs");
    EXPECT_EQ(num_diffuser_frames(inputs.tensor("audio").count(), c.forward.config().at("fps").get<double>()),
              c.forward.tensor("x_t").num_rows());
    EXPECT_EQ(c.given.speech.num_rows(), c.forward.tensor("x_t").num_rows());
  });
}

// Walks and compares each state and estimate that was recorded, and the result.
void expect_walk(const DiffuserCase& c, const Fixture& recorded, const std::string& group,
                 const std::string& initial, const std::string& steps, const DiffusionProcess& process,
                 const Walk& walk) {
  SCOPED_TRACE(group.empty() ? "walk" : group);
  const RecordedNoise noise(recorded, group + initial, group + steps);
  const auto expect = [&](const Tensor& got, const std::string& tensor) {
    if (!recorded.has(group + tensor)) return;
    SCOPED_TRACE(tensor);
    MIEN_EXPECT_CLOSE(got, recorded.tensor(group + tensor), "walk");
  };
  const Tensor result = facediffuser::sample_plainly(
      [&](const Tensor& x_t, std::int64_t step) { return c.predict_x0(x_t, step); },
      c.given.speech.num_rows(), recorded.tensor(group + "final").width(), process, walk, noise,
      [&](int step, const Tensor& x_t, const Tensor& x0) {
        if (step > 0) expect(x_t, "sample_after." + std::to_string(step - 1));
        expect(x0, "pred_xstart." + std::to_string(step));
      });
  expect(result, "sample_after." + std::to_string(process.size() - walk.skip - 1));
  expect(result, "final");
  if (c.is_latent() && walk.sampler.clip_x0) return;
  SCOPED_TRACE("frame by frame");
  const facediffuser::Lane lane{c.given.style, c.given.neutral, &noise, true};
  facediffuser::FrameDiffusion fast(c.folded(), process, walk, {lane});
  expect(fast.next({&c.aligned_speech, 1}).front(), "final");
}

DiffusionProcess whole_process(const DiffuserCase& c, BetaSchedule schedule = BetaSchedule::cosine) {
  return DiffusionProcess(betas_of(schedule, c.num_steps));
}

// Steps of a recorded walk: one noise each.
std::int64_t num_walked(const Fixture& recorded, const std::string& noise) {
  return recorded.file().find(noise)->shape.at(0);
}

TEST(FaceDiffuser, AncestralWalksEndAsRecorded) {
  for_each_diffuser("psample", [](const std::string& name) {
    const DiffuserCase c(name);
    expect_walk(c, c.open("psample"), "", "x_T", "noise", whole_process(c), {});
  });
}

TEST(FaceDiffuser, WalksThatLeaveOutStepsEndAsRecorded) {
  for_each_diffuser("psample_skip", [](const std::string& name) {
    const DiffuserCase c(name);
    const Fixture recorded = c.open("psample_skip");
    expect_walk(c, recorded, "", "initial_noise", "noise", whole_process(c),
                {.skip = c.num_steps - num_walked(recorded, "noise")});
  });
}

TEST(FaceDiffuser, LinearScheduleAndClippingEndAsRecorded) {
  for_each_diffuser("psample_variants", [](const std::string& name) {
    const DiffuserCase c(name);
    const Fixture recorded = c.open("psample_variants");
    expect_walk(c, recorded, "", "initial_noise", "noise", whole_process(c, BetaSchedule::linear),
                {.skip = c.num_steps - num_walked(recorded, "noise")});
    Walk clipped{.skip = c.num_steps - num_walked(recorded, "clip.noise")};
    clipped.sampler.clip_x0 = {.low = 0, .high = 1};
    expect_walk(c, recorded, "clip.", "initial_noise", "noise", whole_process(c), clipped);
  });
}

// The number in a metadata text such as "0.5 for ddim_eta" or "skip_timesteps=2".
double number_in(const std::string& text) { return std::stod(text.substr(text.find_first_of("0123456789"))); }

TEST(FaceDiffuser, DdimAndRespacedWalksEndAsRecorded) {
  for_each_diffuser("ddim", [](const std::string& name) {
    const DiffuserCase c(name);
    const Fixture recorded = c.open("ddim");
    const SamplerKind ddim = SamplerKind::ddim;
    const std::pair<std::string, Walk> groups[] = {
        {"ddim_eta0.", {.sampler = {.kind = ddim}}},
        {"ddim_eta.", {.sampler = {.kind = ddim, .eta = number_in(recorded.metadata("eta"))}}},
        {"respaced_psample.", {}},
        {"ddim_skip.",
         {.sampler = {.kind = ddim},
          .skip = static_cast<std::int64_t>(number_in(recorded.metadata("ddim_skip")))}}};
    for (const auto& [group, walk] : groups) {
      const auto kept = recorded.integers(group + "timestep_map");
      const DiffusionProcess process = whole_process(c).respaced(kept);
      MIEN_EXPECT_CLOSE(process.betas(), recorded.doubles(group + "betas"), "schedule");
      expect_walk(c, recorded, group, "initial_noise", "noise", process, walk);
    }
  });
}

}  // namespace
}  // namespace mien::parity
