// SAiD on LibTorch: the recorded passes of its denoiser, alone and as a batch.
#include "torch_backend.h"
// Behind LibTorch's header, whose macros of that name would win.
#include "said_network_suite.h"
#include "said_sampling_suite.h"

namespace mien::parity {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(Torch, SaidNetwork, torch::Tensor);
INSTANTIATE_TYPED_TEST_SUITE_P(Torch, SaidSampling, torch::Tensor);

TEST(SaidTorch, ABatchWithItsOwnStepsGivesWhatEachItemGives) {
  if (!has_said("unet_forward.safetensors")) GTEST_SKIP() << "no recorded said in " << fixture_root();
  const torch::NoGradGuard no_grad;
  const auto network = said_network<torch::Tensor>(Fixture("said", kSaidWeights));
  const Fixture recorded("said", "unet_forward.safetensors");
  for_each_said_case(recorded, "sample", [&](const std::string& prefix) {
    const auto all = [&](const char* name) {
      const auto& shape = recorded.file().find(prefix + name)->shape;
      auto values = recorded.file().read_float(prefix + name).value();
      return torch::from_blob(values.data(), shape, torch::kFloat).clone();
    };
    const torch::Tensor noise =
        network.denoiser(all("sample"), recorded.integers(prefix + "timesteps"), all("context"));
    MIEN_EXPECT_CLOSE(Backend<torch::Tensor>::values(noise), Backend<torch::Tensor>::values(all("output")),
                      "said noise");
  });
}

}  // namespace
}  // namespace mien::parity
