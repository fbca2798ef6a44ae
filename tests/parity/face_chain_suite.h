#pragma once
// FaceXHuBERT and FaceDiffuser on a tensor library from the waveform on: normalising, encoding, aligning, the
// network.
#include <gtest/gtest.h>

#include "closeness.h"
#include "face_weights.h"
#include "mien/motion/diffusion_process.h"

namespace mien::parity {

template <class T>
class FaceChain : public testing::Test {
 protected:
  static T encoded(const Fixture& weights, const Tensor& wave) {
    return encoder_of<T>(weights)(Backend<T>::given(wave));
  }
  /// Estimates from the recording `wave`, for as many frames as x_t has or the speech covers.
  static Tensor estimate_from(DiffuserCase<T>& c, const Tensor& wave, const Tensor& x_t, std::int64_t step) {
    c.hear(aligned_features(encoded(c.open("weights"), wave), x_t.num_rows(), c.fps));
    return c.predict_x0(rows(x_t, 0, c.num_frames()), step);
  }
};
TYPED_TEST_SUITE_P(FaceChain);

TYPED_TEST_P(FaceChain, FaceXHuBertPredictsFromTheRecording) {
  using B = Operations<TypeParam>;
  for_each_case("facexhubert", "", ".predict.safetensors", [](const std::string& name) {
    const Fixture weights("facexhubert", name + ".weights.safetensors"),
        inputs("facexhubert", name + ".inputs.safetensors"),
        recorded("facexhubert", name + ".predict.safetensors");
    const auto network = facexhubert_of<TypeParam>(weights);
    const TypeParam neutral = Backend<TypeParam>::given(as_row(inputs.tensor("template")));
    int num_cases = 0;
    for (; recorded.has(numbered("case.", num_cases)); ++num_cases) {
      SCOPED_TRACE(numbered("case ", num_cases));
      const auto c = recorded.integers(numbered("case.", num_cases));
      const TypeParam features = TestFixture::encoded(weights, waveform(inputs, numbered(".", c.at(0))));
      const TypeParam pairs = aligned_features(features, B::num_rows(features) / 2, 25);
      MIEN_EXPECT_CLOSE(Backend<TypeParam>::values(
                            network(pairs, B::one_hot(pairs, c.at(1), network.sizes.num_subjects),
                                    B::one_hot(pairs, c.at(2), network.sizes.num_emotions), neutral)),
                        recorded.tensor(numbered("out.", num_cases)), "estimate");
    }
    EXPECT_GT(num_cases, 0);
  });
}

/// The training path takes its length from the true motion: interpolated at 30 fps, cut where the speech ends
/// at 25.
TYPED_TEST_P(FaceChain, FaceXHuBertAlignsItsTrainingPairs) {
  for (const char* run : {"0", "1"})
    for_each_case(
        "facexhubert", "", std::string(".train") + run + ".safetensors", [&](const std::string& name) {
          const Fixture inputs("facexhubert", name + ".inputs.safetensors"),
              recorded("facexhubert", name + ".train" + run + ".safetensors");
          const TypeParam features = TestFixture::encoded(
              Fixture("facexhubert", name + ".weights.safetensors"), waveform(inputs, ".0"));
          MIEN_EXPECT_CLOSE(
              Backend<TypeParam>::values(aligned_features(features, recorded.tensor("vertice").num_rows(),
                                                          recorded.config().at("fps").get<double>())),
              recorded.tensor("gru.in"), "encoder");
        });
}

TYPED_TEST_P(FaceChain, FaceDiffuserEstimatesFromTheRecording) {
  for_each_case("facediffuser", "", ".forward.safetensors", [](const std::string& name) {
    DiffuserCase<TypeParam> c(name);
    MIEN_EXPECT_CLOSE(TestFixture::estimate_from(c, waveform(c.open("inputs")), c.forward.tensor("x_t"),
                                                 c.forward.integers("t.0").at(0)),
                      c.forward.tensor("out.0"), "estimate");
  });
}

TYPED_TEST_P(FaceChain, FaceDiffuserCutsTheMotionWhereTheSpeechEnds) {
  for_each_case("facediffuser", "", ".short_audio.safetensors", [](const std::string& name) {
    DiffuserCase<TypeParam> c(name);
    const Fixture recorded = c.open("short_audio");
    const Tensor audio = recorded.tensor("audio");
    MIEN_EXPECT_CLOSE(TestFixture::estimate_from(c, audio.reshaped({audio.count(), 1}),
                                                 recorded.tensor("x_t"), recorded.integers("t").at(0)),
                      recorded.tensor("out"), "estimate");
  });
}

/// x_t of a training step: the process run forward.
TYPED_TEST_P(FaceChain, FaceDiffuserNoisesTrainingMotionAsRecorded) {
  using B = Operations<TypeParam>;
  for_each_case("facediffuser", "", ".train.safetensors", [](const std::string& name) {
    const DiffuserCase<TypeParam> c(name);
    const Fixture recorded = c.open("train");
    const DiffusionProcess process(betas_of(BetaSchedule::cosine, c.num_steps));
    for (int s = 0; recorded.has(numbered("t.", s)); ++s) {
      const NoiseLevel level = process.level(recorded.integers(numbered("t.", s)).at(0));
      const TypeParam x0 = Backend<TypeParam>::given(recorded.tensor("x_start")),
                      noise = Backend<TypeParam>::given(recorded.tensor(numbered("noise.", s)));
      MIEN_EXPECT_CLOSE(Backend<TypeParam>::values(B::add(B::scale(x0, static_cast<float>(level.alpha)),
                                                          B::scale(noise, static_cast<float>(level.sigma)))),
                        recorded.tensor(numbered("x_t.", s)), "stage");
    }
  });
}

REGISTER_TYPED_TEST_SUITE_P(FaceChain, FaceXHuBertPredictsFromTheRecording, FaceXHuBertAlignsItsTrainingPairs,
                            FaceDiffuserEstimatesFromTheRecording,
                            FaceDiffuserCutsTheMotionWhereTheSpeechEnds,
                            FaceDiffuserNoisesTrainingMotionAsRecorded);

}  // namespace mien::parity
