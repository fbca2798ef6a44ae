// SAiD's checkpoints as its authors' program saves them: imported, loaded, run.
#include "mien/models/said/said_model.h"

#include <unistd.h>

#include <fstream>

#include "closeness.h"
#include "mien/models/import/import_model.h"
#include "mien/models/runtime_parameters.h"
#include "runtime_backend.h"
#include "said_sampling_suite.h"

namespace mien::parity {
namespace {

namespace fs = std::filesystem;

/// A checkpoint as its authors' program saves it, imported, loaded and run.
TEST(SaidCheckpoint, ImportedGivesTheRecordedNoise) {
  if (!has_said("tiny_checkpoint.pth")) GTEST_SKIP() << "no recorded said in " << fixture_root();
  const Fixture recorded("said", "tiny_checkpoint_expected.safetensors");
  const fs::path folder = fs::temp_directory_path() / ("mien_said_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  auto json = nlohmann::json::parse(recorded.metadata("audio"));
  json["model_type"] = "wav2vec2";
  std::ofstream(folder / "config.json") << json.dump();
  ImportOptions options{.sources = {fixture_root() / "said/tiny_checkpoint.pth"}};
  options.encoder = folder / "config.json";
  Progress progress;
  const auto imported = import_model(options, folder / "said.safetensors", progress);
  ASSERT_TRUE(imported) << imported.error().message();
  EXPECT_TRUE(imported.warnings.empty());
  const ModelFile& description = imported->description;
  EXPECT_EQ(architecture_name(description.architecture), "said");
  EXPECT_EQ(description.output.fps, 60);
  EXPECT_EQ(description.output.space, "arkit");
  EXPECT_EQ(description.encoder->normalise_eps, 1e-7);
  EXPECT_EQ(std::to_string(imported->num_tensors), recorded.metadata("state_keys"));

  const auto model = SaidModel::load(folder / "said.safetensors");
  ASSERT_TRUE(model) << model.error().message();
  EXPECT_EQ(model->empty_motion().channels.front(), "jawForward");
  const auto waveform = recorded.file().read_float("waveform").value();
  const auto context = model->context({waveform, 16000}, 1);
  ASSERT_TRUE(context) << context.error().message();
  MIEN_EXPECT_CLOSE(*context, recorded.tensor("embedding"), "speech features");
  const auto steps = recorded.integers("timesteps");
  said::Network<Tensor> network(model->denoiser().sizes());
  const auto file = SafetensorsFile::open(folder / "said.safetensors");
  LoadRuntime load(file.value());
  load.leave_out("audio_encoder.");
  network.visit(load);
  ASSERT_TRUE(load.finish());
  MIEN_EXPECT_CLOSE(network.denoiser(recorded.tensor("sample"), steps, *context),
                    recorded.tensor("output_cond"), "said noise");
  MIEN_EXPECT_CLOSE(network.denoiser(recorded.tensor("sample"), steps, network.null_context(*context)),
                    recorded.tensor("output_uncond"), "said noise");

  SaidOptions performance;
  performance.sampling.num_steps = 4;
  const auto takes = animate(*model, {waveform, 16000}, performance, 2, 1, progress);
  ASSERT_TRUE(takes) << takes.error().message();
  EXPECT_EQ(takes->front().num_frames(), 24);
  EXPECT_NE(takes->at(0).values, takes->at(1).values);
  for (const float v : takes->front().values) EXPECT_TRUE(v >= 0 && v <= 1);
  fs::remove_all(folder);
}

/// The packed denoiser and the packed encoder in the place of the plain ones.
class FastPerformer {
 public:
  explicit FastPerformer(const Fixture& weights, bool is_aligned = true)
      : denoiser_(plain_weights(weights, is_aligned), 1000), encoder_(encoder_of(weights)) {}

  [[nodiscard]] Tensor encode(std::span<const float> waveform, std::int64_t num_frames) const {
    EncodeOptions options;
    options.num_frames = num_frames;
    return encoder_.encode(waveform, options).value();
  }
  void hear(std::vector<Tensor> features) { features_ = std::move(features); }
  [[nodiscard]] said::NoiseNetwork network(std::int64_t num_frames) {
    speech_.clear();
    for (const Tensor& f : features_) speech_.push_back(denoiser_.listen(denoiser_.context(f), num_frames));
    return denoiser_.network(speech_, num_threads);
  }
  [[nodiscard]] std::int64_t num_channels() const { return denoiser_.sizes().num_channels; }
  int num_threads = 1;

 private:
  static said::Network<PlainWeights> plain_weights(const Fixture& weights, bool is_aligned) {
    said::Sizes sizes = said::sizes_of(weights.file()).value();
    sizes.is_aligned = is_aligned;
    said::Network<PlainWeights> network(sizes);
    LoadRuntime load(weights.file());
    load.leave_out("audio_encoder.");
    network.visit(load);
    if (const Status loaded = load.finish(); !loaded) throw std::runtime_error(loaded.error().message());
    return network;
  }
  static EncoderRuntime encoder_of(const Fixture& weights) {
    return EncoderRuntime::load(weights.file(), said_encoder_config(weights)).value();
  }
  said::FastDenoiser denoiser_;
  EncoderRuntime encoder_;
  std::vector<Tensor> features_;
  std::vector<said::FastDenoiser::Speech> speech_;
};

class SaidFast : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_said("ddim.safetensors")) GTEST_SKIP() << "no recorded said in " << fixture_root();
  }
};

TEST_F(SaidFast, WalksEndAsRecorded) {
  FastPerformer performer(Fixture("said", kSaidWeights));
  expect_recorded_walks<Tensor>(performer);
}

TEST_F(SaidFast, EditsEndAsRecorded) {
  FastPerformer performer(Fixture("said", kSaidWeights));
  performer.num_threads = 2;
  expect_recorded_edits<Tensor>(performer);
}

/// The recorded passes, with speech and without: the plain network's within rounding, and the same bits for
/// any number of threads.
void expect_plain_passes(bool is_aligned) {
  const Fixture weights("said", kSaidWeights), recorded("said", "unet_forward.safetensors");
  const auto plain = said_network<Tensor>(weights, is_aligned);
  FastPerformer performer(weights, is_aligned);
  for_each_said_case(recorded, "sample", [&](const std::string& prefix) {
    const std::int64_t step = recorded.integers(prefix + "timesteps").at(0), steps[] = {step};
    const Tensor x = recorded.slice(prefix + "sample", 0), context = recorded.slice(prefix + "context", 0);
    performer.hear({context});
    std::vector<std::vector<float>> outputs;
    for (const int threads : {1, 2, 7}) {
      performer.num_threads = threads;
      Tensor with(x.shape()), without(x.shape()), alone(x.shape());
      const auto network = performer.network(x.num_rows());
      network(step, x.values(), with.values(), without.values());
      network(step, x.values(), alone.values(), {});
      MIEN_EXPECT_CLOSE(with, plain.denoiser(x, steps, context), "said noise");
      MIEN_EXPECT_CLOSE(without, plain.denoiser(x, steps, plain.null_context(context)), "said noise");
      EXPECT_TRUE(std::ranges::equal(alone.values(), with.values()));
      outputs.emplace_back(with.values().begin(), with.values().end());
      outputs.back().insert(outputs.back().end(), without.values().begin(), without.values().end());
      EXPECT_EQ(outputs.back(), outputs.front());
    }
  });
}

TEST_F(SaidFast, PassesEqualThePlainNetworks) { expect_plain_passes(/*is_aligned=*/true); }

/// The paper's ablation.
TEST_F(SaidFast, PassesWithoutAlignmentBiasEqualThePlainNetworks) {
  expect_plain_passes(/*is_aligned=*/false);
}

}  // namespace
}  // namespace mien::parity
