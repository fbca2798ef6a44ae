#pragma once
// FaceXHuBERT on a tensor library, from recorded pairs of speech features: prediction, and the alignment of
// its training path.
#include <gtest/gtest.h>

#include "closeness.h"
#include "face_weights.h"

namespace mien::parity {

template <class T>
class FaceXHuBert : public testing::Test {
 protected:
  static Fixture open(const std::string& name, const std::string& stage) {
    return Fixture("facexhubert", name + "." + stage + ".safetensors");
  }
  /// @param who  the recorded "case": clip, subject, emotion
  static Tensor predicted(const facexhubert::Network<T>& network, const T& features,
                          const std::vector<std::int64_t>& who, const Fixture& inputs) {
    using B = Operations<T>;
    return Backend<T>::values(network(features, B::one_hot(features, who.at(1), network.sizes.num_subjects),
                                      B::one_hot(features, who.at(2), network.sizes.num_emotions),
                                      Backend<T>::given(as_row(inputs.tensor("template")))));
  }
};
TYPED_TEST_SUITE_P(FaceXHuBert);

TYPED_TEST_P(FaceXHuBert, PredictsTheRecordedVertices) {
  for_each_case("facexhubert", "", ".predict.safetensors", [](const std::string& name) {
    const Fixture recorded = TestFixture::open(name, "predict"), inputs = TestFixture::open(name, "inputs");
    const auto network = facexhubert_of<TypeParam>(TestFixture::open(name, "weights"));
    const TypeParam features = Backend<TypeParam>::given(recorded.tensor("gru.in"));
    const auto first = recorded.integers("case.0");
    int num_compared = 0;
    for (int k = 0; recorded.has(numbered("case.", k)); ++k) {
      const auto c = recorded.integers(numbered("case.", k));
      if (c.at(0) != first.at(0)) continue;  // another recording: needs the encoder
      SCOPED_TRACE(numbered("case ", k));
      MIEN_EXPECT_CLOSE(TestFixture::predicted(network, features, c, inputs),
                        recorded.tensor(numbered("out.", k)), "estimate");
      ++num_compared;
    }
    EXPECT_GT(num_compared, 0);
    MIEN_EXPECT_CLOSE(Backend<TypeParam>::values(network.decoder.states(features)), recorded.tensor("gru"),
                      "stage");
  });
}

TYPED_TEST_P(FaceXHuBert, PairsFeaturesAsRecorded) {
  for_each_case("facexhubert", "", ".predict.safetensors", [](const std::string& name) {
    const Fixture recorded = TestFixture::open(name, "predict");
    const TypeParam features = Backend<TypeParam>::given(speech_features(recorded));
    const std::int64_t num_pairs = Operations<TypeParam>::num_rows(features) / 2;
    MIEN_EXPECT_CLOSE(Backend<TypeParam>::values(aligned_features(features, num_pairs, 25)),
                      recorded.tensor("gru.in"), "stage");
  });
}

/// The training path reads the length from the ground truth; train cases hold the GRU's input and the output.
TYPED_TEST_P(FaceXHuBert, TrainingPathGivesTheRecordedVertices) {
  for (const char* run : {"train0", "train1"})
    for_each_case("facexhubert", "", std::string(".") + run + ".safetensors", [&](const std::string& name) {
      const Fixture recorded = TestFixture::open(name, run);
      const auto network = facexhubert_of<TypeParam>(TestFixture::open(name, "weights"));
      MIEN_EXPECT_CLOSE(TestFixture::predicted(network, Backend<TypeParam>::given(recorded.tensor("gru.in")),
                                               recorded.integers("case"), TestFixture::open(name, "inputs")),
                        recorded.tensor("out"), "estimate");
    });
}

REGISTER_TYPED_TEST_SUITE_P(FaceXHuBert, PredictsTheRecordedVertices, PairsFeaturesAsRecorded,
                            TrainingPathGivesTheRecordedVertices);

}  // namespace mien::parity
