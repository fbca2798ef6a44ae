// FaceXHuBERT from recorded pairs of speech features: prediction, and the alignment of its training path.
#include <gtest/gtest.h>

#include "closeness.h"
#include "face_weights.h"
#include "mien/models/alignment.h"
#include "mien/models/facexhubert/network.h"

namespace mien::parity {
namespace {

facexhubert::Network<Tensor> network_of(const std::string& name) {
  const Fixture weights("facexhubert", name + ".weights.safetensors");
  const auto sizes = facexhubert::sizes_of(weights.file());
  if (!sizes) throw std::runtime_error(sizes.error().message());
  return loaded(weights, facexhubert::Network<Tensor>(*sizes));
}

Tensor one_hot(std::int64_t index, std::int64_t width) {
  return Operations<Tensor>::one_hot({}, index, width);
}

Tensor neutral_of(const std::string& name) {
  const Tensor x = Fixture("facexhubert", name + ".inputs.safetensors").tensor("template");
  return x.reshaped({1, x.count()});
}

TEST(FaceXHuBert, PredictsTheRecordedVertices) {
  for_each_case("facexhubert", "", ".predict.safetensors", [](const std::string& name) {
    const Fixture recorded("facexhubert", name + ".predict.safetensors");
    const auto network = network_of(name);
    const Tensor features = recorded.tensor("gru.in");
    const auto first = recorded.integers("case.0");
    int num_compared = 0;
    for (int k = 0; recorded.has("case." + std::to_string(k)); ++k) {
      const auto c = recorded.integers("case." + std::to_string(k));
      if (c.at(0) != first.at(0)) continue;  // another recording: needs the encoder
      SCOPED_TRACE("case " + std::to_string(k));
      const Tensor got = network(features, one_hot(c.at(1), network.sizes.num_subjects),
                                 one_hot(c.at(2), network.sizes.num_emotions), neutral_of(name));
      MIEN_EXPECT_CLOSE(got, recorded.tensor("out." + std::to_string(k)), "estimate");
      ++num_compared;
    }
    EXPECT_GT(num_compared, 0);
    MIEN_EXPECT_CLOSE(network.gru(features), recorded.tensor("gru"), "stage");
  });
}

TEST(FaceXHuBert, PairsFeaturesAsRecorded) {
  for_each_case("facexhubert", "", ".predict.safetensors", [](const std::string& name) {
    const Fixture recorded("facexhubert", name + ".predict.safetensors");
    std::string last = "hub.layer0";
    for (int i = 0; recorded.has("hub.layer" + std::to_string(i)); ++i)
      last = "hub.layer" + std::to_string(i);
    const Tensor features = recorded.tensor(last);
    const Alignment pairs = align_features(features.num_rows(), features.num_rows() / 2, 25);
    MIEN_EXPECT_CLOSE(aligned(features, pairs), recorded.tensor("gru.in"), "stage");
  });
}

// The training path reads the length from the ground truth; train cases hold the GRU's input and the output.
TEST(FaceXHuBert, TrainingPathGivesTheRecordedVertices) {
  for (const char* run : {"0", "1"})
    for_each_case(
        "facexhubert", "", std::string(".train") + run + ".safetensors", [&](const std::string& name) {
          const Fixture recorded("facexhubert", name + ".train" + run + ".safetensors");
          const auto network = network_of(name);
          const auto c = recorded.integers("case");
          const Tensor got = network(recorded.tensor("gru.in"), one_hot(c.at(1), network.sizes.num_subjects),
                                     one_hot(c.at(2), network.sizes.num_emotions), neutral_of(name));
          MIEN_EXPECT_CLOSE(got, recorded.tensor("out"), "estimate");
        });
}

}  // namespace
}  // namespace mien::parity
