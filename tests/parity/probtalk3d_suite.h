#pragma once
// ProbTalk3D on a tensor library T: every recorded stage of both stages, of both latents, and of the draws.
// The same tests for the runtime (probtalk3d_test.cpp) and LibTorch (probtalk3d_torch_test.cpp).
#include <gtest/gtest.h>

#include "closeness.h"
#include "fixture.h"
#include "mien/models/probtalk3d/codes.h"
#include "mien/models/probtalk3d/network.h"
#include "mien/models/probtalk3d/validation.h"
#include "mien/models/speech_encoder/network.h"
#include "recorded_weights.h"

namespace mien::parity {

inline probtalk3d::Sizes recorded_sizes(const Fixture& weights) {
  std::map<std::string, Shape> shapes;
  for (const auto& tensor : weights.file().tensors()) shapes.emplace(tensor.name, tensor.shape);
  const auto sizes = probtalk3d::sizes_of(shapes, std::stoll(weights.metadata("heads")));
  if (!sizes) throw std::runtime_error(sizes.error().message());
  return *sizes;
}

/// Keeps every stage under the name that the recorded files use: "conv", "net0", "net1" ...
template <class T>
struct KeepStages : probtalk3d::EvaluationHooks<T> {
  void stage(const char* name, const T& x) const {
    const bool counted = std::string_view(name) == "net";
    stages->emplace_back(counted ? name + std::to_string((*num_blocks)++) : name, x);
  }
  std::vector<std::pair<std::string, T>>* stages = nullptr;
  int* num_blocks = nullptr;
};

/// Runs a network that takes hooks, and compares each stage that was recorded as <prefix><name>.
template <class T, class Run>
T expect_stages(const Fixture& recorded, const std::string& prefix, Run&& run) {
  std::vector<std::pair<std::string, T>> stages;
  int num_blocks = 0, num_compared = 0;
  KeepStages<T> hooks;
  hooks.stages = &stages, hooks.num_blocks = &num_blocks;
  const T result = run(hooks);
  for (const auto& [name, value] : stages) {
    if (!recorded.has(prefix + name)) continue;
    SCOPED_TRACE(prefix + name);
    MIEN_EXPECT_CLOSE(Backend<T>::values(value), recorded.tensor(prefix + name), "motion stage");
    ++num_compared;
  }
  EXPECT_GT(num_compared, 3) << "stages are recorded under other names";
  return result;
}

template <class T>
T recorded_rows(const Fixture& recorded, const std::string& name) {
  const mien::Tensor x = recorded.tensor(name);
  return Backend<T>::given(x.reshaped({x.num_rows(), x.width()}));
}

/// Codes of a clip: equal to the recorded ones, but where the best is too close to the second.
inline void expect_codes(const std::vector<std::int64_t>& got, const Fixture& recorded,
                         const std::string& name, const std::string& margins) {
  constexpr float kSafeMargin = 1e-2f;
  const auto want = recorded.integers(name);
  const mien::Tensor margin = recorded.tensor(margins);
  ASSERT_EQ(got.size(), want.size());
  for (std::size_t n = 0; n < want.size(); ++n)
    if (margin.values()[n] > kSafeMargin) {
      EXPECT_EQ(got[n], want[n]) << "chunk " << n;
    }
}

/// The latent as codes, each step of it.
template <class T>
void expect_quantised(const probtalk3d::MotionPrior<T>& prior, const T& z, const Fixture& recorded) {
  const auto& quantiser = prior.quantiser;
  const auto expect = [&](const T& got, const char* name) {
    if (!recorded.has(name)) return;
    SCOPED_TRACE(name);
    MIEN_EXPECT_CLOSE(Backend<T>::values(got), recorded.tensor(name), "motion stage");
  };
  expect(quantiser.chunks(z), "mid.chunks");
  const T distances = quantiser.distances(z);
  {
    SCOPED_TRACE("distances");
    MIEN_EXPECT_CLOSE(Backend<T>::values(distances), recorded.tensor("mid.distances"), "code distance");
  }
  const auto codes = probtalk3d::nearest_codes(Operations<T>::values(distances), quantiser.num_codes);
  expect_codes(codes, recorded, "mid.indices", "mid.margins");
  const auto want = recorded.integers("mid.indices");
  expect(Operations<T>::table_rows(quantiser.codebook, want), "mid.embedding_selected");
  expect(quantiser.quantised(z, want), "mid.z_q");
}

template <class T>
void replay_quantised_prior(const std::string& file) {
  const Fixture recorded("probtalk3d", file);
  const auto prior = recorded_network<T>(recorded, probtalk3d::MotionPrior<T>(recorded_sizes(recorded)));
  const T motion = recorded_rows<T>(recorded, "in.motion");
  const T z =
      expect_stages<T>(recorded, "mid.enc.", [&](auto& hooks) { return prior.encoder(motion, hooks); });
  MIEN_EXPECT_CLOSE(Backend<T>::values(z), recorded.tensor("mid.z"), "motion stage");
  expect_quantised(prior, z, recorded);
  const T decoded = expect_stages<T>(recorded, "mid.dec.", [&](auto& hooks) {
    return prior.decoder(recorded_rows<T>(recorded, "mid.z_q"), hooks);
  });
  MIEN_EXPECT_CLOSE(Backend<T>::values(decoded), recorded.tensor("out.motion"), "motion");
  const auto expect_figure = [&](double got, const char* name) {
    SCOPED_TRACE(name);
    const double want = recorded.tensor(name).values()[0];
    EXPECT_NEAR(got, want, 1e-5 * std::abs(want));
  };
  const auto distance =
      probtalk3d::motion_distance(Backend<T>::values(decoded), recorded.tensor("in.motion"));
  expect_figure(distance.mean_l2, "out.metric_mean_l2");
  expect_figure(distance.mean_var, "out.metric_mean_var");
  expect_figure(probtalk3d::code_perplexity(recorded.integers("mid.indices"), prior.quantiser.num_codes),
                "out.perplexity");
}

/// mean and logvar of a latent, and what the decoder makes of it without a factor and with each recorded one.
template <class T>
void expect_gaussian(const probtalk3d::MotionPrior<T>& prior, const T& z, const Fixture& recorded,
                     const std::string& plain_latent, const std::string& plain_motion) {
  const T mean = prior.mean(z), logvar = prior.logvar(z), noise = recorded_rows<T>(recorded, "in.eps");
  MIEN_EXPECT_CLOSE(Backend<T>::values(mean), recorded.tensor("mid.mean"), "motion stage");
  MIEN_EXPECT_CLOSE(Backend<T>::values(logvar), recorded.tensor("mid.logvar"), "motion stage");
  const auto expect = [&](const T& latent, const std::string& latent_name, const std::string& motion_name) {
    SCOPED_TRACE(latent_name);
    MIEN_EXPECT_CLOSE(Backend<T>::values(latent), recorded.tensor(latent_name), "motion stage");
    MIEN_EXPECT_CLOSE(Backend<T>::values(prior.decoder(latent)), recorded.tensor(motion_name), "motion");
  };
  expect(probtalk3d::gaussian_sample(mean, logvar, noise), plain_latent, plain_motion);
  int num_factors = 0;
  for (int factor = 1; factor <= 40; ++factor) {
    const std::string name = "fact" + std::to_string(factor);
    if (!recorded.has("mid.latent_" + name)) continue;
    expect(probtalk3d::gaussian_sample(mean, logvar, noise, static_cast<float>(factor)), "mid.latent_" + name,
           "out.motion_" + name);
    ++num_factors;
  }
  EXPECT_GT(num_factors, 0);
}

template <class T>
void replay_gaussian_prior(const std::string& file) {
  const Fixture recorded("probtalk3d", file);
  const auto prior = recorded_network<T>(recorded, probtalk3d::MotionPrior<T>(recorded_sizes(recorded)));
  const T motion = recorded_rows<T>(recorded, "in.motion");
  const T z =
      expect_stages<T>(recorded, "mid.enc.", [&](auto& hooks) { return prior.encoder(motion, hooks); });
  expect_gaussian(prior, z, recorded, "mid.latent", "out.motion");
}

/// The speech encoder of a stage-2 file on a normalised waveform.
template <class T>
T heard(const Fixture& recorded, const mien::Tensor& waveform) {
  const auto config = encoder_config_from_json(recorded.metadata("hubert"));
  if (!config) throw std::runtime_error(config.error().message());
  const auto encoder =
      recorded_network<T>(recorded, SpeechEncoder<T>(*config), "feature_extractor.audiomodel.");
  return encoder(Backend<T>::given(waveform.reshaped({waveform.count(), 1})));
}

template <class T>
T paired(const T& features) {
  using B = Operations<T>;
  return B::group_rows(B::rows(features, 0, B::num_rows(features) / 2 * 2), 2);
}

template <class T>
T style_of(const Fixture& recorded) {
  const mien::Tensor style = recorded.tensor("in.style_onehot");
  return Backend<T>::given(style.reshaped({1, style.count()}));
}

template <class T>
void replay_stage2(const std::string& file) {
  const Fixture recorded("probtalk3d", file);
  const auto network = recorded_network<T>(recorded, probtalk3d::Network<T>(recorded_sizes(recorded)));
  const T pairs = paired(heard<T>(recorded, recorded.tensor("mid.input_values")));
  MIEN_EXPECT_CLOSE(Backend<T>::values(pairs), recorded.tensor("mid.audio_paired"), "speech features");
  const T z = expect_stages<T>(recorded, "mid.pred.", [&](auto& hooks) {
    return network.predictor(pairs, style_of<T>(recorded), hooks);
  });
  MIEN_EXPECT_CLOSE(Backend<T>::values(z), recorded.tensor("mid.z_a"), "motion stage");
  expect_quantised(network.prior, z, recorded);
  const T decoded = expect_stages<T>(recorded, "mid.dec.", [&](auto& hooks) {
    return network.prior.decoder(recorded_rows<T>(recorded, "mid.z_q"), hooks);
  });
  MIEN_EXPECT_CLOSE(Backend<T>::values(decoded), recorded.tensor("out.motion"), "motion");
}

template <class T>
void replay_gaussian_stage2(const std::string& file) {
  const Fixture recorded("probtalk3d", file);
  const auto network = recorded_network<T>(recorded, probtalk3d::Network<T>(recorded_sizes(recorded)));
  const T features = recorded_rows<T>(recorded, "mid.last_hidden");
  const T z = network.predictor(paired(features), style_of<T>(recorded));
  MIEN_EXPECT_CLOSE(Backend<T>::values(z), recorded.tensor("mid.pred"), "motion stage");
  expect_gaussian(network.prior, z, recorded, "mid.latent_train", "out.motion_train");
}

/// in.<codebook>.T<temperature>.k<place>.s<draw>.exp_race
struct RecordedDraw {
  std::string codebook, name;
  double temperature = 0;
  int place = 1;
};
inline std::vector<RecordedDraw> recorded_draws(const Fixture& recorded) {
  std::vector<RecordedDraw> draws;
  for (const auto& tensor : recorded.file().tensors()) {
    if (!tensor.name.starts_with("in.") || !tensor.name.ends_with(".exp_race")) continue;
    RecordedDraw draw;
    draw.name = tensor.name.substr(3, tensor.name.size() - 3 - 9);
    const auto temperature = draw.name.find(".T"), place = draw.name.find(".k");
    draw.codebook = draw.name.substr(0, temperature);
    draw.temperature = std::stod(draw.name.substr(temperature + 2, place - temperature - 2));
    draw.place = std::stoi(draw.name.substr(place + 2));
    draws.push_back(draw);
  }
  return draws;
}

/// "stage2_audio.safetensors (motion_prior.motion_decoder.*)": the file before the blank.
inline std::string weights_of(const Fixture& recorded) {
  const std::string& text = recorded.metadata("weights_in");
  return text.substr(0, text.find(' '));
}

template <class T>
void replay_draws(const std::string& file) {
  const Fixture recorded("probtalk3d", file), weights("probtalk3d", weights_of(recorded));
  const auto network = recorded_network<T>(weights, probtalk3d::Network<T>(recorded_sizes(weights)));
  const T z = recorded_rows<T>(recorded, "in.z_a");
  const auto draws = recorded_draws(recorded);
  EXPECT_FALSE(draws.empty());
  for (const RecordedDraw& draw : draws) {
    SCOPED_TRACE(draw.name);
    probtalk3d::Quantiser<T> quantiser = network.prior.quantiser;
    const mien::Tensor codebook = recorded.tensor("in." + draw.codebook + ".codebook");
    quantiser.num_codes = codebook.num_rows();
    quantiser.codebook = Backend<T>::parameter(codebook);
    const T distances = quantiser.distances(z);
    MIEN_EXPECT_CLOSE(Backend<T>::values(distances), recorded.tensor("mid." + draw.codebook + ".distances"),
                      "code distance");
    const auto probabilities = probtalk3d::code_probabilities(Operations<T>::values(distances),
                                                              quantiser.num_codes, draw.temperature);
    const std::string of_temperature = draw.name.substr(0, draw.name.find(".k"));
    const mien::Tensor want = recorded.tensor("mid." + of_temperature + ".probabilities");
    MIEN_EXPECT_CLOSE(mien::Tensor(want.shape(), probabilities), want, "code probability");
    const mien::Tensor race = recorded.tensor("in." + draw.name + ".exp_race");
    const auto codes = probtalk3d::draw_codes(
        probabilities, quantiser.num_codes, draw.place,
        [&](std::int64_t chunk, std::span<float> out) { std::ranges::copy(race.row(chunk), out.begin()); });
    EXPECT_EQ(codes, recorded.integers("out." + draw.name + ".indices"));
    const T latent = quantiser.quantised(z, recorded.integers("out." + draw.name + ".indices"));
    MIEN_EXPECT_CLOSE(Backend<T>::values(latent), recorded.tensor("out." + draw.name + ".z_q"),
                      "motion stage");
    MIEN_EXPECT_CLOSE(Backend<T>::values(network.prior.decoder(latent)),
                      recorded.tensor("out." + draw.name + ".motion"), "motion");
  }
}

/// Runs body(file) where the recorded file exists; skips the test where it does not.
template <class Body>
void replay_file(const std::string& file, Body&& body) {
  if (!std::filesystem::exists(fixture_root() / "probtalk3d" / file))
    GTEST_SKIP() << "no recorded probtalk3d/" << file << " in " << fixture_root();
  try {
    body(file);
  } catch (const std::exception& problem) {
    ADD_FAILURE() << file << ": " << problem.what();
  }
}

template <class T>
class ProbTalk3DNetworks : public testing::Test {};
TYPED_TEST_SUITE_P(ProbTalk3DNetworks);

TYPED_TEST_P(ProbTalk3DNetworks, QuantisedPriorGivesTheRecordedStages) {
  replay_file("vqvae_stage1.safetensors", replay_quantised_prior<TypeParam>);
}
TYPED_TEST_P(ProbTalk3DNetworks, GaussianPriorGivesTheRecordedStages) {
  replay_file("vae_stage1.safetensors", replay_gaussian_prior<TypeParam>);
}
TYPED_TEST_P(ProbTalk3DNetworks, SpeechGivesTheRecordedStages) {
  replay_file("stage2_audio.safetensors", replay_stage2<TypeParam>);
}
TYPED_TEST_P(ProbTalk3DNetworks, SpeechGivesTheRecordedGaussianStages) {
  replay_file("vae_stage2.safetensors", replay_gaussian_stage2<TypeParam>);
}
TYPED_TEST_P(ProbTalk3DNetworks, DrawsEndAsRecorded) {
  replay_file("sampling.safetensors", replay_draws<TypeParam>);
}
REGISTER_TYPED_TEST_SUITE_P(ProbTalk3DNetworks, QuantisedPriorGivesTheRecordedStages,
                            GaussianPriorGivesTheRecordedStages, SpeechGivesTheRecordedStages,
                            SpeechGivesTheRecordedGaussianStages, DrawsEndAsRecorded);

}  // namespace mien::parity
