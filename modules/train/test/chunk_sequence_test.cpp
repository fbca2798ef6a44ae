#include "../src/chunk_sequence.h"

#include <gtest/gtest.h>

namespace mien::train {
namespace {

namespace dm = default_model;

// Speech context of chunks 5, 6, ... whose "features" say at which frame their group ends.
torch::Tensor ends_of_groups(std::int64_t num_chunks, std::int64_t width) {
  torch::Tensor speech = torch::empty({1, num_chunks, dm::kContextGroups * width});
  for (std::int64_t c = 0; c < num_chunks; ++c)
    for (std::int64_t g = 0; g < dm::kContextGroups; ++g)
      speech[0][c].narrow(0, g * width, width) =
          static_cast<double>(dm::kChunkFrames * (5 + c) - dm::kGroupFrames * (dm::kContextGroups - 1 - g));
  return speech;
}

TEST(ChunkSequence, AStepHearsTheGroupsThatEndWithItsFirstFrame) {
  constexpr std::int64_t kChunks = 4, kWidth = 2;
  const auto speech = ends_of_groups(kChunks, kWidth);
  for (const dm::EventKind& kind : {dm::kBlinks, dm::kBrowRaises}) {
    const auto steps = speech_of_steps(speech, kind);
    const std::int64_t first = 5 * dm::kChunkFrames / kind.frames;
    ASSERT_EQ(steps.size(1), (kChunks - 1) * dm::kChunkFrames / kind.frames + 1);
    ASSERT_EQ(steps.size(2), kind.groups * kWidth);
    for (std::int64_t s = 0; s < steps.size(1); ++s)
      for (std::int64_t g = 0; g < kind.groups; ++g)
        for (std::int64_t w = 0; w < kWidth; ++w)
          EXPECT_EQ(steps[0][s][g * kWidth + w].item<double>(),
                    static_cast<double>((first + s) * kind.frames - dm::kGroupFrames * (kind.groups - 1 - g)))
              << kind.frames << " frames, step " << s << ", group " << g;
  }
}

}  // namespace
}  // namespace mien::train
