#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "mien/corpus/corpus_reader.h"
#include "mien/corpus/curve_file.h"
#include "mien/corpus/take.h"
#include "mien/corpus/text.h"
#include "test_paths.h"

namespace mien {
namespace {

const std::filesystem::path kFixture = project_path("tests/data/corpus_fixture");
constexpr int kTakes = 4;

TEST(CorpusFixture, HoldsTwelveShortClipsWithSound) {
  const auto reader = CorpusReader::open(kFixture);
  ASSERT_TRUE(reader.has_value()) << reader.error().message();
  EXPECT_EQ(reader->items().size(), 12u);
  double seconds = 0;
  int neutral = 0;
  for (const auto& item : reader->items()) {
    seconds += item.seconds;
    neutral += item.emotion == Emotion::neutral ? 1 : 0;
    EXPECT_EQ(item.engine, "flite");
    EXPECT_EQ(split_of_text(item.text), TextSplit::test) << item.text;
    EXPECT_TRUE(std::filesystem::exists(reader->audio_path(item))) << item.id;
  }
  EXPECT_LE(seconds, 60);
  EXPECT_EQ(neutral, 6);
}

// Curves drawn from phones on this machine equal those stored on another. Exact equality is not asked for:
// the last bit of exp and sin belongs to the C library.
TEST(CorpusFixture, CurvesDrawnFromPhonesAreTheStoredOnes) {
  const auto reader = CorpusReader::open(kFixture);
  ASSERT_TRUE(reader.has_value()) << reader.error().message();
  ASSERT_EQ(reader->info().generator_hash, generator_hash())
      << "the generator changed: build the fixture again, see docs/corpus.md";
  for (const auto& item : reader->items()) {
    const auto stored = read_curves(curve_path(kFixture, item.id));
    ASSERT_TRUE(stored.has_value()) << stored.error().message();
    ASSERT_EQ(stored->num_takes, kTakes + 1);
    ASSERT_TRUE(stored->first_is_mean);
    const auto said = reader->utterance(item);
    ASSERT_TRUE(said.has_value()) << said.error().message();
    for (int k = 0; k < kTakes; ++k) {
      const auto drawn = draw_take(*said, *find_speaker(item.speaker), item.emotion, item.intensity(),
                                   take_seed(reader->info().seed, item.id, static_cast<std::uint64_t>(k)))
                             .motion;
      const auto want = stored->take(k + 1);
      ASSERT_EQ(drawn.values.size(), want.values.size()) << item.id;
      for (std::size_t i = 0; i < want.values.size(); ++i) {
        // A half holds 11 bits; head angles reach some degrees.
        const float tolerance = 6e-4f * std::max(1.0f, std::abs(want.values[i]));
        ASSERT_NEAR(drawn.values[i], want.values[i], tolerance) << item.id << " take " << k << " value " << i;
      }
    }
  }
}

TEST(CorpusFixture, MeanLiesBetweenTheTakes) {
  const auto reader = CorpusReader::open(kFixture);
  ASSERT_TRUE(reader.has_value()) << reader.error().message();
  const auto takes = reader->takes(reader->items()[0], kTakes);
  ASSERT_TRUE(takes.has_value() && takes->mean.has_value());
  // The lower face hardly differs between takes, so the mean of 64 others is near to the mean of these.
  const auto jaw = *takes->mean->find("jawOpen");
  double difference = 0, size = 0;
  for (std::int64_t n = 0; n < takes->mean->num_frames(); ++n) {
    double mean = 0;
    for (const auto& take : takes->takes) mean += take.frame(n)[static_cast<std::size_t>(jaw)] / kTakes;
    difference += std::abs(mean - takes->mean->frame(n)[static_cast<std::size_t>(jaw)]);
    size += mean;
  }
  EXPECT_GT(size, 0);
  EXPECT_LT(difference, 0.25 * size);
}

}  // namespace
}  // namespace mien
