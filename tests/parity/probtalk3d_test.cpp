// ProbTalk3D at run time: the suite, and what surrounds the networks.
#include <gtest/gtest.h>

#include "mien/models/probtalk3d/conventions.h"
#include "probtalk3d_suite.h"
#include "runtime_backend.h"

namespace mien::parity {

INSTANTIATE_TYPED_TEST_SUITE_P(Runtime, ProbTalk3DNetworks, Tensor);

namespace {

// From the recording on: level, normalisation, encoder, both networks, the nearest codes.
TEST(ProbTalk3D, RecordingGivesTheRecordedParameters) {
  replay_file("stage2_audio.safetensors", [](const std::string& file) {
    const Fixture recorded("probtalk3d", file);
    Tensor wave = recorded.tensor("in.audio_float");
    const auto pcm = recorded.file().as<std::int32_t>("in.pcm16").value();
    for (std::size_t i = 0; i < pcm.size(); ++i)
      ASSERT_EQ(wave.values()[i], static_cast<float>(pcm[i]) / 32768.0f);
    probtalk3d::stretch_waveform(wave.values());
    MIEN_EXPECT_CLOSE(wave, recorded.tensor("mid.audio_minmax"), "encoder waveform");
    normalise_waveform(wave.values(), EncoderConfig().normalise_eps);
    MIEN_EXPECT_CLOSE(wave, recorded.tensor("mid.input_values"), "stage");
    const auto network =
        recorded_network<Tensor>(recorded, probtalk3d::Network<Tensor>(recorded_sizes(recorded)));
    const Tensor z = network.predictor(paired(heard<Tensor>(recorded, wave)), style_of<Tensor>(recorded));
    const auto& quantiser = network.prior.quantiser;
    const auto codes = probtalk3d::nearest_codes(quantiser.distances(z).values(), quantiser.num_codes);
    Tensor motion = network.prior.decoder(quantiser.quantised(z, codes));
    MIEN_EXPECT_CLOSE(motion, recorded.tensor("out.motion"), "motion");
    undo_scaler(probtalk3d::published_scaler(motion.width()), motion.values());
    const auto flame = recorded.doubles("out.flame403");
    const std::int64_t width = recorded.file().find("out.flame403")->shape.back();
    const std::int64_t num_expression = motion.width() - probtalk3d::kNumJaw;
    for (std::int64_t n = 0; n < motion.num_rows(); ++n) {
      const std::span<const double> want(flame.data() + n * width, static_cast<std::size_t>(width));
      for (std::int64_t c = 0; c < motion.width(); ++c) {
        const std::int64_t column = c < num_expression ? 300 + c : 400 + c - num_expression;
        EXPECT_NEAR(motion.row(n)[static_cast<std::size_t>(c)], want[static_cast<std::size_t>(column)], 6e-4);
      }
    }
  });
}

TEST(ProbTalk3D, StylesAreTheRecordedColumns) {
  replay_file("style.safetensors", [](const std::string& file) {
    const Fixture recorded("probtalk3d", file);
    const auto identities = probtalk3d::published_identities();
    const std::string keys = recorded.metadata("keys");
    const Tensor want = recorded.tensor("out.onehot");
    std::size_t start = 0;
    for (std::int64_t row = 0; row < want.num_rows(); ++row) {
      const std::string key = keys.substr(start, keys.find(',', start) - start);
      start += key.size() + 1;
      const auto who = std::ranges::find(identities, key.substr(0, key.find('_')));
      ASSERT_NE(who, identities.end()) << key;
      const auto weights = probtalk3d::style_weights(who - identities.begin(), 32,
                                                     key.at(key.size() - 3) - '0', 8, key.back() - '0', 3);
      EXPECT_TRUE(std::ranges::equal(weights, want.row(row))) << key;
    }
  });
}

TEST(ProbTalk3D, ScalesMotionAndSoundAsRecorded) {
  replay_file("normalisation.safetensors", [](const std::string& file) {
    const Fixture recorded("probtalk3d", file);
    const Tensor flame = recorded.tensor("in.flame403"), want = recorded.tensor("out.normalised53");
    const ModelScaler scaler = probtalk3d::published_scaler(want.width());
    Tensor motion =
        concat_last(std::vector<Tensor>{columns(flame, 300, want.width() - 3), columns(flame, 400, 3)});
    apply_scaler(scaler, motion.values());
    EXPECT_TRUE(std::ranges::equal(motion.values(), want.values())) << largest_difference(motion, want);
    undo_scaler(scaler, motion.values());
    const Tensor back = recorded.tensor("out.back53");
    EXPECT_TRUE(std::ranges::equal(motion.values(), back.values())) << largest_difference(motion, back);
    int i = 0;
    for (; recorded.has("in.audio" + std::to_string(i)); ++i) {
      SCOPED_TRACE("audio " + std::to_string(i));
      const std::string n = std::to_string(i);
      Tensor wave = recorded.tensor("in.audio" + n);
      normalise_waveform(wave.values(), EncoderConfig().normalise_eps);
      MIEN_EXPECT_CLOSE(wave, recorded.tensor("out.input_values_no_minmax" + n), "stage");
      wave = recorded.tensor("in.audio" + n);
      probtalk3d::stretch_waveform(wave.values());
      MIEN_EXPECT_CLOSE(wave, recorded.tensor("out.minmax" + n), "encoder waveform");
      normalise_waveform(wave.values(), EncoderConfig().normalise_eps);
      MIEN_EXPECT_CLOSE(wave, recorded.tensor("out.input_values" + n), "stage");
    }
    EXPECT_GT(i, 0);
  });
}

}  // namespace
}  // namespace mien::parity
