// SAiD's denoiser: every recorded pass, stage by stage, on the tensor library of the program that includes
// this.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "closeness.h"
#include "mien/tensor/ops.h"
#include "said_fixture.h"

namespace mien::parity {

template <class T>
class SaidNetwork : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_said("unet_forward.safetensors")) GTEST_SKIP() << "no recorded said in " << fixture_root();
  }
};
TYPED_TEST_SUITE_P(SaidNetwork);

/// Stages of a pass under the names of the recorded ones: "middle_block.1", "middle_block.1.attn1" ...
template <class T>
struct RecordSaidStages : said::PassHooks<T> {
  void stage(std::string_view module, std::string_view part, const T& x) const {
    std::string name(module);
    if (!part.empty()) name.append(1, '.').append(part);
    stages->emplace_back(std::move(name), x);
  }
  std::vector<std::pair<std::string, T>>* stages = nullptr;
};

inline Tensor recorded_said_stage(const Fixture& recorded, const std::string& name, std::int64_t item) {
  const Shape& shape = recorded.file().find(name)->shape;
  if (shape.size() == 2) {  // of the step: [B, width]
    Tensor all({shape[0], shape[1]}, recorded.file().read_float(name).value());
    return rows(all, item, 1);
  }
  // Convolutions are recorded channels first.
  const bool rows_first = name.ends_with(".attn1") || name.ends_with(".attn2") || name.ends_with(".ff");
  return rows_first ? recorded.slice(name, item) : transposed(recorded.slice(name, item));
}

TYPED_TEST_P(SaidNetwork, EqualsEveryRecordedPassAndStage) {
  using T = TypeParam;
  const auto network = said_network<T>(Fixture("said", kSaidWeights));
  const Fixture recorded("said", "unet_forward.safetensors");
  std::size_t num_stages = 0;
  const int count = for_each_said_case(recorded, "sample", [&](const std::string& prefix) {
    const auto steps = recorded.integers(prefix + "timesteps");
    const std::int64_t batch = recorded.file().find(prefix + "sample")->shape.at(0);
    for (std::int64_t item = 0; item < batch; ++item) {
      SCOPED_TRACE(item);
      const std::int64_t step[] = {steps[steps.size() == 1 ? 0 : static_cast<std::size_t>(item)]};
      std::vector<std::pair<std::string, T>> stages;
      RecordSaidStages<T> hooks;
      hooks.stages = &stages;
      const T noise = network.denoiser(Backend<T>::given(recorded.slice(prefix + "sample", item)), step,
                                       Backend<T>::given(recorded.slice(prefix + "context", item)), hooks);
      MIEN_EXPECT_CLOSE(Backend<T>::values(noise), recorded.slice(prefix + "output", item), "said noise");
      for (const auto& [name, value] : stages) {
        const std::string stored = prefix + "act." + name;
        if (!recorded.has(stored)) continue;
        SCOPED_TRACE(name);
        MIEN_EXPECT_CLOSE(Backend<T>::values(value), recorded_said_stage(recorded, stored, item),
                          "said noise");
        ++num_stages;
      }
    }
  });
  EXPECT_GT(count, 0);
  std::size_t recorded_stages = 0;
  for (const auto& tensor : recorded.file().tensors())
    if (tensor.name.find(".act.") != std::string::npos)
      recorded_stages += static_cast<std::size_t>(tensor.shape.at(0));
  EXPECT_EQ(num_stages, recorded_stages) << "a recorded stage has no counterpart";
}

TYPED_TEST_P(SaidNetwork, NullContextRepeatsTheLearnedVector) {
  using T = TypeParam;
  const Fixture weights("said", kSaidWeights);
  const auto network = said_network<T>(weights);
  const Tensor null = weights.tensor("null_cond_emb");
  const Tensor context = Backend<T>::values(network.null_context(Backend<T>::given(Tensor({3, 32}))));
  ASSERT_EQ(context.num_rows(), 3);
  for (std::int64_t n = 0; n < 3; ++n)
    for (std::int64_t i = 0; i < null.count(); ++i) ASSERT_EQ(context.row(n)[i], null.values()[i]);
}

REGISTER_TYPED_TEST_SUITE_P(SaidNetwork, EqualsEveryRecordedPassAndStage, NullContextRepeatsTheLearnedVector);

}  // namespace mien::parity
