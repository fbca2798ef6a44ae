// SAiD's denoiser on the runtime, and what it has beside the network: alignment, sinusoids.
#include "mien/models/said/alignment.h"
#include "runtime_backend.h"
#include "said_network_suite.h"

namespace mien::parity {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(Runtime, SaidNetwork, Tensor);

TEST(SaidAlignment, EqualsTheRecordedMasks) {
  if (!has_said("alignment_masks.safetensors")) GTEST_SKIP() << "no recorded said in " << fixture_root();
  const Fixture recorded("said", "alignment_masks.safetensors");
  const auto pairs = nlohmann::json::parse(recorded.metadata("pairs"));
  for (const auto& pair : pairs) {
    const auto frames = pair.at(0).get<std::int64_t>(), context = pair.at(1).get<std::int64_t>();
    const std::string name = std::to_string(frames) + "_" + std::to_string(context);
    SCOPED_TRACE(name);
    const auto ranges = said::aligned_keys(frames, context);
    const auto want = recorded.file().as<std::int32_t>("range_" + name).value();
    const auto mask = recorded.file().as<std::uint8_t>("mask_" + name).value();
    ASSERT_EQ(ranges.size() * 2, want.size());
    for (std::size_t n = 0; n < ranges.size(); ++n) {
      EXPECT_EQ(ranges[n].first, want[2 * n]) << n;
      EXPECT_EQ(ranges[n].end, want[2 * n + 1]) << n;
      for (std::int64_t t = 0; t < context; ++t) {
        const bool seen = t >= ranges[n].first && t < ranges[n].end;
        EXPECT_EQ(seen, mask[n * static_cast<std::size_t>(context) + static_cast<std::size_t>(t)] == 0)
            << n << ' ' << t;
      }
    }
  }
  EXPECT_GT(pairs.size(), 0u);
}

TEST(SaidAlignment, StepSinusoidsEqualTheRecorded) {
  if (!has_said("unet_forward.safetensors")) GTEST_SKIP() << "no recorded said in " << fixture_root();
  const Fixture recorded("said", "unet_forward.safetensors");
  const Tensor want = recorded.tensor("case0.timestep_embedding");
  const auto got = said::step_sinusoids(recorded.integers("case0.timesteps"), want.width());
  MIEN_EXPECT_CLOSE(Tensor(want.shape(), got), want, "said sinusoids");
}

}  // namespace
}  // namespace mien::parity
