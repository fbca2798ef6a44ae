// FaceXHuBERT and FaceDiffuser from the waveform on: normalising, encoding, aligning, the network.
#include <gtest/gtest.h>

#include "closeness.h"
#include "face_weights.h"
#include "mien/models/alignment.h"
#include "mien/models/facexhubert/network.h"
#include "mien/models/speech_encoder/network.h"

namespace mien::parity {
namespace {

// The shrunken encoder of a case, as its configuration and weights say.
SpeechEncoder<Tensor> encoder_of(const Fixture& weights) {
  const auto sizes = weights.config().at("hubert");
  EncoderConfig c;
  c.hidden_size = sizes.at("hidden");
  c.num_hidden_layers = sizes.at("layers");
  c.num_attention_heads = sizes.at("heads");
  c.intermediate_size = sizes.at("inter");
  c.conv_dim.assign(c.conv_dim.size(), sizes.at("conv").get<std::int64_t>());
  SpeechEncoder<Tensor> encoder(c);
  LoadRuntime load(weights.file(), "audio_encoder.");
  encoder.visit(load);
  if (const Status status = load.finish(); !status) throw std::runtime_error(status.error().message());
  return encoder;
}

// The raw recording where there is one, normalised by us; it must be the recorded normalised one.
Tensor waveform(const Fixture& inputs, const std::string& suffix) {
  Tensor wave = inputs.tensor("audio_raw" + suffix);
  normalise_waveform(wave.values(), EncoderConfig().normalise_eps);
  MIEN_EXPECT_CLOSE(wave, inputs.tensor("audio" + suffix), "stage");
  return wave.reshaped({wave.count(), 1});
}

Tensor one_hot(std::int64_t index, std::int64_t width) {
  return Operations<Tensor>::one_hot({}, index, width);
}

TEST(FaceChain, FaceXHuBertPredictsFromTheRecording) {
  for_each_case("facexhubert", "", ".predict.safetensors", [](const std::string& name) {
    const Fixture weights("facexhubert", name + ".weights.safetensors"),
        inputs("facexhubert", name + ".inputs.safetensors"),
        recorded("facexhubert", name + ".predict.safetensors");
    const SpeechEncoder<Tensor> encoder = encoder_of(weights);
    const auto sizes = facexhubert::sizes_of(weights.file());
    ASSERT_TRUE(sizes);
    const auto network = loaded(weights, facexhubert::Network<Tensor>(*sizes));
    const Tensor face = inputs.tensor("template"), neutral = face.reshaped({1, face.count()});
    int num_cases = 0;
    for (; recorded.has("case." + std::to_string(num_cases)); ++num_cases) {
      SCOPED_TRACE("case " + std::to_string(num_cases));
      const auto c = recorded.integers("case." + std::to_string(num_cases));
      const Tensor features = encoder(waveform(inputs, "." + std::to_string(c.at(0))));
      const Tensor pairs =
          aligned(features, align_features(features.num_rows(), features.num_rows() / 2, 25));
      MIEN_EXPECT_CLOSE(network(pairs, one_hot(c.at(1), sizes->num_subjects),
                                one_hot(c.at(2), sizes->num_emotions), neutral),
                        recorded.tensor("out." + std::to_string(num_cases)), "estimate");
    }
    EXPECT_GT(num_cases, 0);
  });
}

// The training path takes its length from the true motion: interpolated at 30 fps, cut where the speech ends
// at 25.
TEST(FaceChain, FaceXHuBertAlignsItsTrainingPairs) {
  for (const char* run : {"0", "1"})
    for_each_case(
        "facexhubert", "", std::string(".train") + run + ".safetensors", [&](const std::string& name) {
          const Fixture weights("facexhubert", name + ".weights.safetensors"),
              inputs("facexhubert", name + ".inputs.safetensors"),
              recorded("facexhubert", name + ".train" + run + ".safetensors");
          const Tensor features = encoder_of(weights)(waveform(inputs, ".0"));
          const Alignment pairs = align_features(features.num_rows(), recorded.tensor("vertice").num_rows(),
                                                 recorded.config().at("fps").get<double>());
          MIEN_EXPECT_CLOSE(aligned(features, pairs), recorded.tensor("gru.in"), "stage");
        });
}

// Estimates for t.0 ... from the recording `audio`, for as many frames as x_t has or the speech covers.
Tensor estimate_from(DiffuserCase& c, const Tensor& wave, const Tensor& x_t, std::int64_t step) {
  const Tensor features = encoder_of(c.open("weights"))(wave);
  const Alignment alignment =
      align_features(features.num_rows(), x_t.num_rows(), c.forward.config().at("fps").get<double>());
  const Tensor speech = aligned(features, alignment);
  std::visit([&](const auto& n) { c.given.speech = n.speech_tokens(speech); }, c.network);
  return c.predict_x0(rows(x_t, 0, alignment.num_frames), step);
}

TEST(FaceChain, FaceDiffuserEstimatesFromTheRecording) {
  for_each_case("facediffuser", "", ".forward.safetensors", [](const std::string& name) {
    DiffuserCase c(name);
    MIEN_EXPECT_CLOSE(estimate_from(c, waveform(c.open("inputs"), ""), c.forward.tensor("x_t"),
                                    c.forward.integers("t.0").at(0)),
                      c.forward.tensor("out.0"), "estimate");
  });
}

TEST(FaceChain, FaceDiffuserCutsTheMotionWhereTheSpeechEnds) {
  for_each_case("facediffuser", "", ".short_audio.safetensors", [](const std::string& name) {
    DiffuserCase c(name);
    const Fixture recorded = c.open("short_audio");
    const Tensor audio = recorded.tensor("audio");
    MIEN_EXPECT_CLOSE(estimate_from(c, audio.reshaped({audio.count(), 1}), recorded.tensor("x_t"),
                                    recorded.integers("t").at(0)),
                      recorded.tensor("out"), "estimate");
  });
}

// x_t of a training step: the process run forward.
TEST(FaceChain, FaceDiffuserNoisesTrainingMotionAsRecorded) {
  for_each_case("facediffuser", "", ".train.safetensors", [](const std::string& name) {
    const DiffuserCase c(name);
    const Fixture recorded = c.open("train");
    const DiffusionProcess process(betas_of(BetaSchedule::cosine, c.num_steps));
    for (int s = 0; recorded.has("t." + std::to_string(s)); ++s) {
      const NoiseLevel level = process.level(recorded.integers("t." + std::to_string(s)).at(0));
      const Tensor x0 = recorded.tensor("x_start"), noise = recorded.tensor("noise." + std::to_string(s));
      MIEN_EXPECT_CLOSE(
          add(scale(x0, static_cast<float>(level.alpha)), scale(noise, static_cast<float>(level.sigma))),
          recorded.tensor("x_t." + std::to_string(s)), "stage");
    }
  });
}

}  // namespace
}  // namespace mien::parity
