// How SAiD's denoiser learns, on LibTorch: recorded losses, gradients, updates and windows.
#include "torch_backend.h"
// Behind LibTorch's header, whose macros of that name would win.
#include <unistd.h>

#include <numeric>
#include <optional>

#include "face_weights.h"
#include "mien/train/optimiser.h"
#include "mien/train/said_training.h"
#include "said_sampling_suite.h"
#include "torch_fixture.h"

namespace mien::parity {
namespace {

using namespace train;

constexpr double kGradientDistance = 1e-4;  // of a whole tensor, as a part of its size

std::vector<std::string> names_in(const Fixture& fixture, const std::string& key) {
  return nlohmann::json::parse(fixture.metadata(key)).get<std::vector<std::string>>();
}
std::vector<std::uint8_t> bytes_in(const Fixture& fixture, const std::string& name) {
  const auto all = fixture.file().as<std::uint8_t>(name).value();
  return {all.begin(), all.end()};
}

class SaidTrainingParity : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_said(kSaidWeights)) GTEST_SKIP() << "no recorded said in " << fixture_root();
    const Fixture weights("said", kSaidWeights);
    network.reset(
        new SaidNetwork{said_encoder<torch::Tensor>(weights), said_network<torch::Tensor>(weights)});
    for (const auto& e : parameters(network->encoder)) *e.slot = e.slot->detach();
    learning = parameters(network->head);
    for (const auto& e : learning) *e.slot = e.slot->detach().requires_grad_(true);
    const auto width = static_cast<std::size_t>(network->head.sizes.num_channels);
    // The cases are batches; sequences are needed by what draws them alone.
    stage.emplace(*network,
                  std::vector<CoefficientSequence>{{"", std::vector<float>(width), std::vector<float>(1)}},
                  std::vector<std::size_t>(width), SaidTrainingOptions{});
  }
  static SaidBatch batch_of(const Fixture& recorded, const std::string& prefix) {
    SaidBatch batch;
    batch.coefficients = stored(recorded, prefix + "coeffs");
    batch.conditioned = bytes_in(recorded, prefix + "cond");
    batch.steps = recorded.integers(prefix + "timesteps");
    batch.noise = stored(recorded, prefix + "noise");
    return batch;
  }
  static std::vector<double> parts_of(const SaidLoss& loss) {
    std::vector<double> parts = {loss.prediction.item<double>(), loss.velocity.item<double>()};
    if (loss.vertices.defined()) parts.push_back(loss.vertices.item<double>());
    return parts;
  }

  std::unique_ptr<SaidNetwork> network;
  std::vector<Collect::Entry> learning;
  std::optional<SaidStage> stage;
};

TEST_F(SaidTrainingParity, HasTheRecordedLossAndGradients) {
  if (!has_said("train_loss.safetensors"))
    GTEST_SKIP() << "no recorded said/train_loss in " << fixture_root();
  const Fixture recorded("said", "train_loss.safetensors");
  SaidBatch batch = batch_of(recorded, "");
  torch::Tensor sound = stored(recorded, "waveform");
  for (std::int64_t i = 0; i < sound.size(0); ++i)
    normalise_waveform({sound[i].data_ptr<float>(), static_cast<std::size_t>(sound.size(1))},
                       network->encoder.config.normalise_eps);
  batch.waveform = sound.unsqueeze(-1);
  const torch::Tensor features = stage->encode(batch, nullptr);
  MIEN_EXPECT_CLOSE(values_of(features), values_of(stored(recorded, "audio_embedding")), "speech features");
  MIEN_EXPECT_CLOSE(values_of(stage->diffuse(batch)), values_of(stored(recorded, "noisy")), "stage");
  const torch::Tensor made = stage->estimate(batch, stored(recorded, "audio_embedding"), false);
  MIEN_EXPECT_CLOSE(values_of(made), values_of(stored(recorded, "prediction")), "said noise");
  const SaidLoss loss = stage->loss_of(batch, made);
  auto parts = parts_of(loss);
  parts.push_back(stage->total(loss).item<double>());
  MIEN_EXPECT_CLOSE(parts, recorded.doubles("loss"), "said loss");

  stage->total(loss).backward();
  const auto names = names_in(recorded, "grad_norm_names");
  std::map<std::string, torch::Tensor> gradients;
  double square = 0;
  for (const auto& e : learning) {
    ASSERT_TRUE(e.slot->grad().defined()) << e.name;
    gradients[e.name] = e.slot->grad();
    square += e.slot->grad().square().sum().item<double>();
  }
  ASSERT_EQ(names.size(), learning.size());
  std::vector<double> norms;
  for (const auto& name : names) norms.push_back(gradients.at(name).norm().item<double>());
  MIEN_EXPECT_CLOSE(norms, recorded.doubles("grad_norms"), "said gradient norm");
  MIEN_EXPECT_CLOSE(std::vector{std::sqrt(square)}, recorded.doubles("grad_norm_total"),
                    "said gradient norm");
  for (const auto& tensor : recorded.file().tensors()) {
    if (!tensor.name.starts_with("grad.")) continue;
    const torch::Tensor want = stored(recorded, tensor.name);
    EXPECT_LE(relative_distance(gradients.at(tensor.name.substr(5)), want), kGradientDistance) << tensor.name;
  }
}

TEST_F(SaidTrainingParity, HasTheRecordedLossOfEveryVariant) {
  if (!has_said("train_loss.safetensors"))
    GTEST_SKIP() << "no recorded said/train_loss in " << fixture_root();
  const torch::NoGradGuard no_grad;
  const Fixture recorded("said", "train_loss.safetensors");
  const SaidBatch batch = batch_of(recorded, "");
  const torch::Tensor made = stored(recorded, "prediction");
  const torch::Tensor deviation = stored(recorded, "variant.std").reshape({-1}),
                      residuals = stored(recorded, "variant.delta");
  const auto expect = [&](Prediction prediction, const SaidLossOptions& options, const char* name) {
    SCOPED_TRACE(name);
    std::vector<NoiseLevel> levels;
    for (const std::int64_t step : batch.steps) levels.push_back(said::training_process().level(step));
    const torch::Tensor target = said_target(prediction, batch.coefficients, batch.noise, levels);
    if (prediction == Prediction::velocity) {
      MIEN_EXPECT_CLOSE(values_of(target), values_of(stored(recorded, "velocity_target")), "stage");
    }
    MIEN_EXPECT_CLOSE(parts_of(said_loss(made, target, options)), recorded.doubles(name), "said loss");
  };
  expect(Prediction::epsilon, {false, deviation, {}}, "variant.loss_std");
  expect(Prediction::epsilon, {false, {}, residuals}, "variant.loss_delta");
  expect(Prediction::epsilon, {false, deviation, residuals}, "variant.loss_std_delta");
  expect(Prediction::x0, {}, "variant.loss_sample");
  expect(Prediction::velocity, {}, "variant.loss_v");
}

TEST_F(SaidTrainingParity, UpdatesAsRecorded) {
  if (!has_said("train_steps.safetensors"))
    GTEST_SKIP() << "no recorded said/train_steps in " << fixture_root();
  const Fixture recorded("said", "train_steps.safetensors");
  const auto settings = nlohmann::json::parse(recorded.metadata("steps"));
  const auto num_steps = settings.at("n").get<std::int64_t>();
  std::map<std::string, torch::Tensor> before;
  for (const auto& e : learning) before[e.name] = e.slot->detach().clone();
  const auto checkpoint =
      std::filesystem::path(testing::TempDir()) / ("mien_said_" + std::to_string(getpid()) + ".safetensors");
  std::filesystem::remove(checkpoint);
  std::vector<double> losses, norms, rates;
  Progress progress;
  const auto done = run_stage(
      "said", learning,
      StageOptions::warm_adamw(num_steps, settings.at("lr").get<double>(),
                               settings.at("warmup").get<std::int64_t>(), settings.at("ema").get<double>()),
      checkpoint,
      [&](std::int64_t step) -> Result<torch::Tensor> {
        const std::string prefix = numbered("step", step) + ".";
        const SaidBatch batch = batch_of(recorded, prefix);
        const SaidLoss loss = stage->loss_of(
            batch, stage->estimate(batch, stored(recorded, prefix + "audio_embedding"), false));
        for (const double part : parts_of(loss)) losses.push_back(part);
        losses.push_back(stage->total(loss).item<double>());
        return stage->total(loss);
      },
      progress,
      [&](const StepReport& r) {
        norms.push_back(r.gradient_norm);
        rates.push_back(r.learning_rate);
      });
  ASSERT_TRUE(done) << done.error().message();
  MIEN_EXPECT_CLOSE(losses, recorded.doubles("losses"), "said loss");
  MIEN_EXPECT_CLOSE(norms, recorded.doubles("grad_norms_before_clip"), "said gradient norm");
  MIEN_EXPECT_CLOSE(rates, recorded.doubles("lr_used"), "schedule");

  // The checkpoint holds what was learnt beside the average, which the network has now.
  const auto state = SafetensorsFile::open(checkpoint);
  ASSERT_TRUE(state) << state.error().message();
  const auto names = names_in(recorded, "param_names");
  std::vector<double> learnt, averaged, moved;
  for (const auto& name : names) {
    auto values = state->read_float(name).value();
    const torch::Tensor now = torch::from_blob(values.data(), before.at(name).sizes(), torch::kFloat).clone();
    const torch::Tensor average = *std::ranges::find(learning, name, &Collect::Entry::name)->slot;
    learnt.push_back(now.norm().item<double>());
    averaged.push_back(average.norm().item<double>());
    moved.push_back((now - before.at(name)).norm().item<double>());
    if (!recorded.has("param." + name)) continue;
    SCOPED_TRACE(name);
    MIEN_EXPECT_CLOSE(values_of(now), values_of(stored(recorded, "param." + name)), "said update");
    MIEN_EXPECT_CLOSE(values_of(average), values_of(stored(recorded, "ema." + name)), "said update");
  }
  MIEN_EXPECT_CLOSE(learnt, recorded.doubles("param_norms"), "said weight norm");
  MIEN_EXPECT_CLOSE(averaged, recorded.doubles("ema_norms"), "said weight norm");
  MIEN_EXPECT_CLOSE(moved, recorded.doubles("param_change_norms"), "said change norm");
  std::filesystem::remove(checkpoint);
}

TEST(SaidTraining, CutsTheRecordedSound) {
  if (!has_said("train_windows.safetensors"))
    GTEST_SKIP() << "no recorded said/train_windows in " << fixture_root();
  const Fixture recorded("said", "train_windows.safetensors");
  const auto draws = recorded.integers("draws");
  const std::int64_t window = recorded.integers("window").at(0);
  std::size_t i = 0;
  for (; recorded.has(numbered("item", static_cast<std::int64_t>(i)) + ".waveform_len"); ++i) {
    const std::string item = numbered("item", static_cast<std::int64_t>(i)) + ".";
    SCOPED_TRACE(item);
    std::vector<float> ramp(static_cast<std::size_t>(recorded.integers(item + "waveform_len").at(0)));
    for (std::size_t s = 0; s < ramp.size(); ++s) ramp[s] = static_cast<float>(s);
    const std::vector<float> sound = said_sound_window(ramp, draws.at(3 * i), window, draws.at(3 * i + 2));
    ASSERT_EQ(static_cast<std::int64_t>(sound.size()), recorded.integers(item + "waveform_window_len").at(0));
    const auto as_integers = [](auto begin, auto end) { return std::vector<std::int64_t>(begin, end); };
    EXPECT_EQ(as_integers(sound.begin(), sound.begin() + 8),
              recorded.integers(item + "waveform_window_first"));
    EXPECT_EQ(as_integers(sound.end() - 8, sound.end()), recorded.integers(item + "waveform_window_last"));
    EXPECT_EQ(std::ranges::count(sound, sound.front()), recorded.integers(item + "leading_repeats").at(0));
    EXPECT_EQ(std::ranges::count(sound, sound.back()), recorded.integers(item + "trailing_repeats").at(0));
    EXPECT_EQ(std::accumulate(sound.begin(), sound.end(), 0.0),
              recorded.doubles(item + "waveform_window_sum").at(0));
  }
  EXPECT_GT(i, 0u);
}

}  // namespace
}  // namespace mien::parity
