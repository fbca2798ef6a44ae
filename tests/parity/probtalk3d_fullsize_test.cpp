// ProbTalk3D at its published size, with weights that follow from their names: from the recording to the
// parameters.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "closeness.h"
#include "fixture.h"
#include "mien/models/probtalk3d/codes.h"
#include "mien/models/probtalk3d/conventions.h"
#include "mien/models/probtalk3d/network.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/nn/runtime_operations.h"

namespace mien::parity {
namespace {

/// The values that a parameter has by the formula of the recorded case.
class Formula {
 public:
  Formula(std::string salt, double codebook_bound)
      : salt_(std::move(salt)), codebook_bound_(codebook_bound) {}
  [[nodiscard]] std::vector<float> values(const std::string& name, const Shape& shape) const {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : salt_ + name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    std::int64_t count = 1, fan_in = 1;
    for (std::size_t i = 0; i < shape.size(); ++i) {
      count *= shape[i];
      if (i > 0) fan_in *= shape[i];
    }
    double offset = -1, factor = 2;  // offset + factor u, then times `scale` and plus `shift`
    double scale = std::sqrt(3.0 / static_cast<double>(fan_in)), shift = 0;
    if (name.ends_with("weight_g")) {
      offset = 0, factor = 1, scale = 1, shift = 0.5;
    } else if (name.ends_with("quantize.embedding.weight")) {
      scale = codebook_bound_;
    } else if (shape.size() == 1) {
      scale = name.ends_with("weight") ? 0.25 : 0.1;
      shift = name.ends_with("weight") ? 1 : 0;
    }
    std::vector<float> values(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::uint64_t z = hash + (i + 1) * 0x9E3779B97F4A7C15u;
      z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
      z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
      z ^= z >> 31;
      const double u = static_cast<double>(z >> 40) / 16777216.0;
      values[i] = static_cast<float>(shift + (offset + factor * u) * scale);
    }
    return values;
  }

 private:
  std::string salt_;
  double codebook_bound_;
};

class FillByFormula : public ParameterVisitor<FillByFormula> {
 public:
  FillByFormula(const Formula& formula, std::string prefix, const Fixture& recorded)
      : formula_(formula), prefix_(std::move(prefix)), recorded_(recorded) {}
  void matrix(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in, Init) {
    slot = PackedMatrix(values(name, {out, in}), out, in);
  }
  void convolution(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init) {
    slot = PackedMatrix(tap_major(Tensor({out, in, kernel}, values(name, {out, in, kernel}))));
  }
  void tensor(std::string_view name, Tensor& slot, const Shape& shape, Init) {
    slot = Tensor(shape, values(name, shape));
  }
  std::int64_t num_values = 0;
  int num_checked = 0;

 private:
  std::vector<float> values(std::string_view name, const Shape& shape) {
    auto all = formula_.values(prefix_ + full_name(name), shape);
    num_values += static_cast<std::int64_t>(all.size());
    if (const std::string parameter = prefix_ + full_name(name); recorded_.has("check.sum64." + parameter)) {
      const auto first = recorded_.file().read_float("check.first8." + parameter).value();
      for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(all[i], first[i]) << parameter;
      const double sum = std::accumulate(all.begin(), all.end(), 0.0);
      EXPECT_NEAR(sum, recorded_.doubles("check.sum64." + parameter).at(0), 1e-6) << parameter;
      ++num_checked;
    }
    return all;
  }
  const Formula& formula_;
  std::string prefix_;
  const Fixture& recorded_;
};

TEST(ProbTalk3DFullSize, RecordingGivesTheRecordedParameters) {
  for_each_case("probtalk3d", "fullsize_", "ipe.safetensors", [](const std::string& name) {
    const Fixture recorded("probtalk3d", "fullsize_" + name + "ipe.safetensors");
    const Formula formula(recorded.metadata("salt"), std::stod(recorded.metadata("codebook_bound")));
    probtalk3d::Sizes sizes;
    sizes.predictor_blocks = 12;
    sizes.condition = 1536;
    sizes.style = recorded.tensor("in.style_onehot").count();
    const EncoderConfig config;
    SpeechEncoder<Tensor> encoder(config);
    FillByFormula encoder_weights(formula, "feature_extractor.audiomodel.", recorded);
    encoder.visit(encoder_weights);
    probtalk3d::Network<Tensor> network(sizes);
    FillByFormula weights(formula, "", recorded);
    network.visit(weights);
    EXPECT_EQ(encoder_weights.num_values + weights.num_values, std::stoll(recorded.metadata("parameters")));

    EXPECT_GT(encoder_weights.num_checked + weights.num_checked, 0);

    const auto pcm = recorded.file().as<std::int16_t>("in.pcm16").value();
    Tensor wave({static_cast<std::int64_t>(pcm.size()), 1});
    for (std::size_t i = 0; i < pcm.size(); ++i) wave.values()[i] = static_cast<float>(pcm[i]) / 32768.0f;
    probtalk3d::stretch_waveform(wave.values());
    normalise_waveform(wave.values(), config.normalise_eps);
    const Tensor features = encoder(wave);
    const auto kept = recorded.integers("in.hubert_rows");
    MIEN_EXPECT_CLOSE(embedding_rows(features, kept), recorded.tensor("mid.hubert_last_hidden_rows"),
                      "encoder");

    const Tensor pairs = group_rows(rows(features, 0, features.num_rows() / 2 * 2), 2);
    const Tensor style = recorded.tensor("in.style_onehot");
    const Tensor z = network.predictor(pairs, style.reshaped({1, style.count()}));
    MIEN_EXPECT_CLOSE(z, recorded.tensor("mid.z_a"), "full-size latent");
    const auto& quantiser = network.prior.quantiser;
    const auto codes = probtalk3d::nearest_codes(quantiser.distances(z).values(), quantiser.num_codes);
    EXPECT_EQ(codes, recorded.integers("mid.indices"));
    const Tensor motion = network.prior.decoder(quantiser.quantised(z, codes));
    MIEN_EXPECT_CLOSE(motion, recorded.tensor("out.motion"), "motion");
  });
}

}  // namespace
}  // namespace mien::parity
