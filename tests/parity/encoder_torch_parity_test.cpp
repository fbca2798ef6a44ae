// Speech encoders on LibTorch, in double: every recorded stage, and the gradients of a loss.
#include <gtest/gtest.h>
#include <torch/torch.h>

#include "closeness.h"
#include "encoder_fixture.h"
#include "mien/train/torch_operations.h"
#include "torch_fixture.h"

namespace mien::parity {
namespace {

using torch::Tensor;

Tensor to_torch(const mien::Tensor& x) {
  const auto options = torch::TensorOptions().dtype(torch::kFloat);
  return torch::from_blob(const_cast<float*>(x.data()), x.shape(), options).to(torch::kDouble);
}

/// Reads a network as doubles and keeps its parameters by name.
class LoadDoubles : public ParameterVisitor<LoadDoubles> {
 public:
  LoadDoubles(const EncoderModel& model)
      : weights_(model.folder, "model.safetensors"), prefix_(model.prefix) {}
  void matrix(std::string_view name, Tensor& slot, std::int64_t out, std::int64_t in, Init init) {
    tensor(name, slot, {out, in}, init);
  }
  void convolution(std::string_view name, Tensor& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init init) {
    tensor(name, slot, {out, in, kernel}, init);
  }
  void tensor(std::string_view name, Tensor& slot, const Shape& shape, Init) {
    slot = to_torch(weights_.tensor(prefix_ + full_name(name))).reshape(shape).clone();
    parameters[full_name(name)] = &slot;
  }
  void optional(std::string_view name, Tensor& slot, const Shape& shape, Init init) {
    if (weights_.has(prefix_ + full_name(name))) tensor(name, slot, shape, init);
  }
  std::map<std::string, Tensor*> parameters;

 private:
  Fixture weights_;
  std::string prefix_;
};

TEST(TorchEncoder, EqualsEveryRecordedStage) {
  const auto models = encoder_models();
  if (models.empty()) GTEST_SKIP() << "no recorded encoders in " << fixture_root();
  const torch::NoGradGuard no_grad;
  for (const auto& model : models) {
    SpeechEncoder<Tensor> encoder(model.config);
    LoadDoubles load(model);
    encoder.visit(load);
    for (const auto& file : model.files) {
      SCOPED_TRACE(model.folder + "/" + file);
      const EncoderCase given(model, file);
      std::vector<std::pair<std::string, Tensor>> stages;
      RecordStages<Tensor> hooks;
      hooks.stages = &stages;
      stages.emplace_back("final", encoder(to_torch(given.waveform).unsqueeze(0), given.call(), hooks));
      for (const auto& [name, value] : stages) {
        if (!given.recorded.has(name)) continue;
        SCOPED_TRACE(name);
        MIEN_EXPECT_CLOSE(values_of(value), values_of(given.recorded.tensor(name)), "encoder in double");
      }
    }
  }
}

/// A batch of clips gives each what it gets alone, where padding is masked and no norm looks across time.
TEST(TorchEncoder, TreatsClipsOfABatchAlone) {
  for (const auto& model : encoder_models()) {
    if (!model.config.conv_layer_norm || model.files.empty()) continue;
    SCOPED_TRACE(model.folder);
    const torch::NoGradGuard no_grad;
    SpeechEncoder<Tensor> encoder(model.config);
    LoadDoubles load(model);
    encoder.visit(load);
    const Tensor clip = to_torch(EncoderCase(model, model.files.front()).waveform);
    const std::int64_t shorter = clip.size(0) / 2, whole = clip.size(0);
    const Tensor batch =
        torch::stack({clip, torch::constant_pad_nd(clip.narrow(0, 0, shorter), {0, 0, 0, whole - shorter})});
    const std::vector<std::int64_t> valid = {model.config.num_frames(whole),
                                             model.config.num_frames(shorter)};
    const Tensor both = encoder(batch, {0, valid, {}, {}});
    const Tensor alone = encoder(clip.unsqueeze(0)), half = encoder(clip.narrow(0, 0, shorter).unsqueeze(0));
    EXPECT_LT((both[0] - alone[0]).abs().max().item<double>(), 1e-12);
    EXPECT_LT((both[1].narrow(0, 0, valid[1]) - half[0]).abs().max().item<double>(), 1e-12);
  }
}

TEST(TorchEncoder, HasTheRecordedGradients) {
  bool any = false;
  for (const auto& model : encoder_models()) {
    for (const auto& file : model.gradient_files) {
      any = true;
      SCOPED_TRACE(model.folder + "/" + file);
      const Fixture recorded(model.folder, file);
      const EncoderCase given(model, file.substr(0, file.find("_gradients")) + ".ref.safetensors");
      SpeechEncoder<Tensor> encoder(model.config);
      LoadDoubles load(model);
      encoder.visit(load);
      std::size_t num_gradients = 0;
      for (auto& [name, slot] : load.parameters) slot->requires_grad_(recorded.has("grad." + name));
      const Tensor target = to_torch(recorded.tensor("target")).unsqueeze(0);
      const Tensor loss =
          (encoder(to_torch(given.waveform).unsqueeze(0), given.call()) - target).square().mean();
      EXPECT_NEAR(loss.item<double>(), recorded.doubles("loss").at(0), 1e-6);
      loss.backward();
      for (const auto& [name, slot] : load.parameters) {
        if (!recorded.has("grad." + name)) continue;
        SCOPED_TRACE(name);
        ASSERT_TRUE(slot->grad().defined());
        MIEN_EXPECT_CLOSE(values_of(slot->grad()), values_of(recorded.tensor("grad." + name)),
                          "encoder gradient");
        ++num_gradients;
      }
      EXPECT_EQ(num_gradients + 2, recorded.file().tensors().size())
          << "a recorded gradient has no parameter";
    }
  }
  if (!any) GTEST_SKIP() << "no recorded gradients in " << fixture_root();
}

}  // namespace
}  // namespace mien::parity
