// SAiD on the runtime: schedule, lengths, and the recorded walks and edits.
#include "mien/models/said/speech_front.h"
#include "runtime_backend.h"
#include "said_sampling_suite.h"

namespace mien::parity {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(Runtime, SaidSampling, Tensor);

TEST(SaidSchedule, EqualsTheRecordedBits) {
  if (!has_said("ddim.safetensors")) GTEST_SKIP() << "no recorded said in " << fixture_root();
  const Fixture recorded("said", "ddim.safetensors");
  const auto betas = recorded.file().read_float("schedule.betas").value();
  const auto alpha_bars = recorded.file().read_float("schedule.alphas_cumprod").value();
  const auto trained = static_cast<std::int64_t>(betas.size());
  const auto process = said::training_process(BetaSchedule::cosine, trained);
  const auto own_betas = betas_of(BetaSchedule::cosine, trained);
  for (std::size_t i = 0; i < betas.size(); ++i) {
    EXPECT_EQ(static_cast<float>(own_betas[i]), betas[i]) << i;
    EXPECT_EQ(process.alpha_bar(static_cast<std::int64_t>(i)), static_cast<double>(alpha_bars[i])) << i;
  }
  int count = 0;
  for (const auto& tensor : recorded.file().tensors()) {
    if (!tensor.name.starts_with("schedule.timesteps_")) continue;
    SCOPED_TRACE(tensor.name);
    const auto want = recorded.file().as<std::int32_t>(tensor.name).value();
    const auto steps = said::walked_steps(static_cast<std::int64_t>(want.size()), trained);
    ASSERT_TRUE(steps);
    EXPECT_TRUE(std::equal(steps->begin(), steps->end(), want.begin(), want.end()));
    const bool is_odd = want.size() > betas.size() / 2 && want.size() != betas.size();
    EXPECT_EQ(steps.warnings.size(), is_odd ? 1u : 0u);
    ++count;
  }
  EXPECT_GT(count, 0);
  EXPECT_FALSE(said::walked_steps(trained + 1, trained));
  EXPECT_FALSE(said::walked_steps(0, trained));
}

TEST(SaidSpeech, HasTheRecordedLengths) {
  if (!has_said("fit_audio.safetensors")) GTEST_SKIP() << "no recorded said in " << fixture_root();
  const Fixture recorded("said", "fit_audio.safetensors");
  const auto table = recorded.integers("table");
  for (std::size_t at = 0; at + 6 <= table.size(); at += 6) {
    SCOPED_TRACE(std::to_string(table[at]) + " samples at " + std::to_string(table[at + 1]));
    const auto length = said::speech_length(table[at], table[at + 1], table[at + 2]);
    EXPECT_EQ(length.padded_samples, table[at + 3]);
    EXPECT_EQ(length.num_frames, table[at + 4]);
    EXPECT_EQ(length.model_frames, table[at + 5]);
  }
  EXPECT_GT(table.size(), 0u);
}

}  // namespace
}  // namespace mien::parity
