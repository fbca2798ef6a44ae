// The packed encoder, on every recorded pass that it can be given (it has no masks).
#include <gtest/gtest.h>

#include "closeness.h"
#include "encoder_fixture.h"
#include "mien/models/speech_encoder/encoder_runtime.h"

namespace mien::parity {
namespace {

TEST(FastEncoder, EqualsEveryRecordedPass) {
  const auto models = encoder_models();
  if (models.empty()) GTEST_SKIP() << "no recorded encoders in " << fixture_root();
  int num_passes = 0;
  for (const auto& model : models) {
    EncoderConfig config = model.config;
    config.do_normalize = false;  // input_values are normalised
    const auto weights = SafetensorsFile::open(fixture_root() / model.folder / "model.safetensors");
    ASSERT_TRUE(weights) << weights.error().message();
    const auto encoder = EncoderRuntime::load(*weights, config, model.prefix);
    ASSERT_TRUE(encoder) << encoder.error().message();
    for (const auto& file : model.files) {
      SCOPED_TRACE(model.folder + "/" + file);
      const EncoderCase given(model, file);
      const EncoderCall call = given.call();
      if (!call.valid_frames.empty() || !call.masked_frames.empty()) continue;
      EncodeOptions options;
      options.num_frames = call.num_frames;
      options.num_threads = 2;
      options.on_hidden = [&](std::int64_t i, const Tensor& h) {
        const std::string name = "layer." + std::to_string(i - 1);
        // After the last layer of a stable encoder comes its norm, which is "final".
        if (i == 0 || !given.recorded.has(name) ||
            (config.do_stable_layer_norm && i == config.num_hidden_layers))
          return;
        SCOPED_TRACE(name);
        MIEN_EXPECT_CLOSE(h, given.recorded.tensor(name), "encoder");
      };
      const auto h = encoder->encode(given.waveform.values(), options);
      ASSERT_TRUE(h) << h.error().message();
      MIEN_EXPECT_CLOSE(*h, given.recorded.tensor("final"), "encoder");
      ++num_passes;
    }
  }
  EXPECT_GT(num_passes, 0);
}

TEST(FastEncoder, LoadsFromTheWeightsOfARecordedModelOnly) {
  const auto models = encoder_models();
  if (models.empty()) GTEST_SKIP() << "no recorded encoders in " << fixture_root();
  const auto weights = SafetensorsFile::open(fixture_root() / models[0].folder / "model.safetensors");
  ASSERT_TRUE(weights);
  EncoderConfig larger = models[0].config;
  larger.hidden_size *= 2;
  for (const auto& [config, prefix] : {std::pair{larger, models[0].prefix}, {models[0].config, "no.such."}}) {
    const auto encoder = EncoderRuntime::load(*weights, config, prefix);
    ASSERT_FALSE(encoder);
    EXPECT_EQ(encoder.error().code, Errc::incompatible);
  }
}

}  // namespace
}  // namespace mien::parity
