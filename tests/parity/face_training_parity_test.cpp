// FaceXHuBERT and FaceDiffuser on LibTorch, speech encoder included: recorded forward passes, losses,
// gradients and steps of Adam.
#include <gtest/gtest.h>
#include <torch/torch.h>
#include <unistd.h>

#include "closeness.h"
#include "face_weights.h"
#include "mien/train/face_training.h"
#include "mien/train/optimiser.h"
#include "torch_fixture.h"

namespace mien::parity {
namespace {

using namespace train;

std::vector<float> floats_of(const mien::Tensor& x) { return {x.values().begin(), x.values().end()}; }

torch::Tensor to_torch(const mien::Tensor& x) {
  return torch::from_blob(const_cast<float*>(x.data()), {1, x.num_rows(), x.width()}, torch::kFloat).clone();
}

FaceNetwork::Head head_of(const SafetensorsFile& weights) {
  using T = torch::Tensor;
  if (weights.find("fc.weight") != nullptr)
    return facexhubert::Network<T>(taken(facexhubert::sizes_of(weights)));
  const auto sizes = taken(facediffuser::sizes_of(weights));
  if (sizes.variant == facediffuser::Variant::vertices) return facediffuser::VertexDenoiser<T>(sizes);
  if (sizes.variant == facediffuser::Variant::beat) return facediffuser::BeatDenoiser<T>(sizes);
  return facediffuser::DammDenoiser<T>(sizes);
}

/// A recorded network, in evaluation mode, and its inputs.
struct FaceCase {
  FaceCase(std::string_view system, const std::string& case_name)
      : folder(system),
        name(case_name),
        weights(folder, name + ".weights.safetensors"),
        inputs(folder, name + ".inputs.safetensors"),
        config(inputs.config()),
        network{SpeechEncoder<torch::Tensor>(recorded_encoder(config.at("hubert"))), head_of(weights.file()),
                config.at("fps").get<double>()} {
    initialise_as_published(network, 1);
    const Status loaded = load_parameters(parameters(network), weights.file());
    if (!loaded) throw std::runtime_error(loaded.error().message());
    learning = taken(freeze(parameters(network), published_frozen()));
    options.diffusion_steps = config.value("steps", std::int64_t{1});
    stage.emplace(network, FaceSequences{}, options);
  }
  /// @param audio  "audio", or "audio.0" where a case has several
  [[nodiscard]] FaceSequence sequence(const Fixture& from, const std::string& audio) const {
    FaceSequence s;
    s.name = audio;
    s.waveform = floats_of(from.tensor(audio));
    if (inputs.has("template")) s.neutral = floats_of(inputs.tensor("template"));
    if (network.num_styles() > 0)
      s.style = one_hot_weights(config.value("style", std::int64_t{0}), network.num_styles());
    return s;
  }

  std::string folder, name;
  Fixture weights, inputs;
  nlohmann::json config;
  FaceNetwork network;
  std::vector<Collect::Entry> learning;
  FaceTrainingOptions options;
  std::optional<FaceStage> stage;
};

TEST(TorchFaceDiffuser, GivesTheRecordedEstimates) {
  const torch::NoGradGuard no_grad;
  for_each_case("facediffuser", "", ".forward.safetensors", [](const std::string& name) {
    FaceCase face("facediffuser", name);
    const auto expect = [&](const Fixture& recorded, const FaceSequence& sequence, const std::string& t,
                            const std::string& out) {
      FaceSequence with_length = sequence;
      const mien::Tensor x_t = recorded.tensor("x_t");
      with_length.motion = floats_of(x_t);
      const auto got =
          taken(face.stage->estimate(with_length, {recorded.integers(t).at(0), to_torch(x_t)}, nullptr));
      MIEN_EXPECT_CLOSE(values_of(got.motion), values_of(recorded.tensor(out)), "estimate");
    };
    const Fixture forward(face.folder, name + ".forward.safetensors");
    for (int i = 0; forward.has("t." + std::to_string(i)); ++i)
      expect(forward, face.sequence(face.inputs, "audio"), "t." + std::to_string(i),
             "out." + std::to_string(i));
    if (std::filesystem::exists(fixture_root() / face.folder / (name + ".short_audio.safetensors"))) {
      const Fixture cut(face.folder, name + ".short_audio.safetensors");
      FaceSequence shorter = face.sequence(cut, "audio");
      shorter.name = "short";
      expect(cut, shorter, "t", "out");
    }
  });
}

TEST(TorchFaceXHuBert, GivesTheRecordedVertices) {
  const torch::NoGradGuard no_grad;
  for_each_case("facexhubert", "", ".predict.safetensors", [](const std::string& name) {
    FaceCase face("facexhubert", name);
    const Fixture recorded(face.folder, name + ".predict.safetensors");
    for (int k = 0; recorded.has("case." + std::to_string(k)); ++k) {
      const auto c = recorded.integers("case." + std::to_string(k));
      const mien::Tensor want = recorded.tensor("out." + std::to_string(k));
      FaceSequence s = face.sequence(face.inputs, "audio." + std::to_string(c.at(0)));
      s.motion = floats_of(want);  // its length: half the features
      s.style = one_hot_weights(c.at(1), face.network.num_styles());
      s.emotion = c.at(2);
      MIEN_EXPECT_CLOSE(values_of(taken(face.stage->estimate(s, {}, nullptr)).motion), values_of(want),
                        "estimate");
    }
  });
}

void expect_gradients(const FaceCase& face, const Fixture& recorded) {
  std::size_t num_recorded = 0, num_found = 0;
  for (const auto& stored : recorded.file().tensors())
    num_recorded += stored.name.starts_with("grad.") ? 1 : 0;
  for (const auto& e : face.learning) {
    SCOPED_TRACE(e.name);
    if (!recorded.has("grad." + e.name)) {
      EXPECT_FALSE(e.slot->grad().defined()) << "no gradient was recorded";
      continue;
    }
    ++num_found;
    ASSERT_TRUE(e.slot->grad().defined());
    MIEN_EXPECT_CLOSE(values_of(e.slot->grad()), values_of(recorded.tensor("grad." + e.name)),
                      "face gradient");
    e.slot->mutable_grad() = torch::Tensor();
  }
  EXPECT_EQ(num_found, num_recorded) << "a recorded gradient has no parameter that learns";
}

/// Two steps of Adam with their losses and, where recorded, gradients of the second loss. (The recorder kept
/// the buffers of the first gradients, which the second pass filled again: the recorded gradient of the last
/// bias is not the one that the recorded first output implies.) Between the steps the run is resumed.
void expect_training(FaceCase& face, const Fixture& recorded,
                     const std::function<Result<torch::Tensor>(std::int64_t)>& loss) {
  const auto checkpoint = std::filesystem::path(testing::TempDir()) /
                          ("mien_parity_" + std::to_string(getpid()) + ".safetensors");
  std::filesystem::remove(checkpoint);
  const auto run_to = [&](std::int64_t num_steps) {
    Progress progress;
    const auto done = run_stage(face.name, face.learning, StageOptions::plain_adam(num_steps, 1e-4),
                                checkpoint, loss, progress, [&](const StepReport& r) {
                                  const std::string want = "loss." + std::to_string(r.step);
                                  MIEN_EXPECT_CLOSE(std::vector<double>{r.loss},
                                                    values_of(recorded.tensor(want)), "face loss");
                                });
    EXPECT_TRUE(done) << done.error().message();
  };
  run_to(1);
  if (recorded.has("grad." + face.learning.back().name)) {
    for (const auto& e : face.learning) {
      e.slot->mutable_grad() = torch::Tensor();
      e.slot->requires_grad_(true);
    }
    taken(loss(1)).backward();
    expect_gradients(face, recorded);
  }
  run_to(2);
  std::filesystem::remove(checkpoint);
  for (const auto& e : face.learning) {
    if (!recorded.has("adam2." + e.name)) continue;
    SCOPED_TRACE(e.name);
    MIEN_EXPECT_CLOSE(values_of(*e.slot), values_of(recorded.tensor("adam2." + e.name)), "after Adam");
  }
}

TEST(TorchFaceDiffuser, LearnsAsRecorded) {
  for_each_case("facediffuser", "", ".train.safetensors", [](const std::string& name) {
    FaceCase face("facediffuser", name);
    const Fixture recorded(face.folder, name + ".train.safetensors");
    FaceSequence s = face.sequence(face.inputs, "audio");
    s.motion = floats_of(recorded.tensor("x_start"));
    expect_training(face, recorded, [&](std::int64_t step) -> Result<torch::Tensor> {
      const std::string i = std::to_string(step);
      const std::int64_t t = recorded.integers("t." + i).at(0);
      const torch::Tensor x_t = face.stage->diffuse(to_torch(recorded.tensor("x_start")),
                                                    to_torch(recorded.tensor("noise." + i)), t);
      MIEN_EXPECT_CLOSE(values_of(x_t), values_of(recorded.tensor("x_t." + i)), "estimate");
      MIEN_TRY(const auto made, face.stage->estimate(s, {t, x_t}, nullptr));
      return face.stage->loss_of(made);
    });
  });
}

TEST(TorchFaceXHuBert, LearnsAsRecorded) {
  for (const char* run : {".train0", ".train1"})
    for_each_case("facexhubert", "", std::string(run) + ".safetensors", [&](const std::string& name) {
      FaceCase face("facexhubert", name);
      const Fixture recorded(face.folder, name + run + ".safetensors");
      const auto c = recorded.integers("case");
      FaceSequence s = face.sequence(face.inputs, "audio." + std::to_string(c.at(0)));
      s.motion = floats_of(recorded.tensor("vertice"));
      s.style = one_hot_weights(c.at(1), face.network.num_styles());
      s.emotion = c.at(2);
      const auto made = taken(face.stage->estimate(s, {}, nullptr));
      MIEN_EXPECT_CLOSE(values_of(made.speech), values_of(recorded.tensor("gru.in")), "speech features");
      MIEN_EXPECT_CLOSE(values_of(made.motion), values_of(recorded.tensor("out")), "estimate");
      expect_training(face, recorded, [&](std::int64_t) -> Result<torch::Tensor> {
        MIEN_TRY(const auto again, face.stage->estimate(s, {}, nullptr));
        return face.stage->loss_of(again);
      });
    });
}

}  // namespace
}  // namespace mien::parity
