#include "mien/corpus/corpus_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "mien/base/file.h"
#include "mien/base/random.h"
#include "mien/core/arkit.h"
#include "mien/corpus/corpus_reader.h"
#include "mien/corpus/curve_file.h"
#include "mien/corpus/take.h"
#include "synthetic_utterance.h"

namespace mien {
namespace {

CorpusItem item_of(const std::string& id, const Utterance& utterance) {
  return {.id = id,
          .split = "train",
          .engine = "flite",
          .voice = "slt",
          .language = "en",
          .speaker = "S04",
          .emotion = Emotion::happy,
          .level = 2,
          .seconds = utterance.seconds,
          .num_frames = num_motion_frames(utterance.seconds, 60),
          .is_question = utterance.is_question,
          .text = "Peter bought a big map."};
}

TEST(CorpusFiles, ItemsRoundTrip) {
  Utterance utterance = synthetic_utterance(3, 1);
  round_to_file(utterance);
  std::vector<CorpusItem> items = {item_of("a_0", utterance), item_of("b-1.x", utterance)};
  items[1].text = "tab\there\nand line";
  const auto back = parse_items(format_items(items), "items.tsv");
  ASSERT_TRUE(back.has_value()) << back.error().message();
  ASSERT_EQ(back->size(), 2u);
  EXPECT_EQ((*back)[0].id, "a_0");
  EXPECT_EQ((*back)[0].emotion, Emotion::happy);
  EXPECT_EQ((*back)[0].intensity(), 0.65f);
  EXPECT_EQ((*back)[0].seconds, utterance.seconds);
  EXPECT_EQ((*back)[0].text, items[0].text);
  EXPECT_EQ((*back)[1].text, "tab here and line");
  EXPECT_TRUE(parse_items(format_items({}), "items.tsv")->empty());
}

TEST(CorpusFiles, PhonesAndAccentsRoundTripAfterRounding) {
  Utterance utterance = synthetic_utterance(10, 2);
  round_to_file(utterance);
  const auto phones = parse_phones(format_phones(utterance.phones), "p.tsv");
  ASSERT_TRUE(phones.has_value()) << phones.error().message();
  ASSERT_EQ(phones->size(), utterance.phones.size());
  for (std::size_t i = 0; i < phones->size(); ++i) {
    const PhoneSegment &a = (*phones)[i], &b = utterance.phones[i];
    EXPECT_EQ(a.start_s, b.start_s);
    EXPECT_EQ(a.end_s, b.end_s);
    EXPECT_EQ(a.label, b.label);
    EXPECT_EQ(a.visemes, b.visemes);
    EXPECT_EQ(a.prominence, b.prominence);
    ASSERT_EQ(a.closure.has_value(), b.closure.has_value());
    if (a.closure) {
      EXPECT_EQ(a.closure->start_s, b.closure->start_s);
      EXPECT_EQ(a.closure->end_s, b.closure->end_s);
    }
  }
  const auto accents = parse_accents(format_accents(utterance.accents_s), "a.txt");
  ASSERT_TRUE(accents.has_value());
  EXPECT_EQ(*accents, utterance.accents_s);
  EXPECT_TRUE(parse_accents("", "a.txt")->empty());
}

TEST(CorpusFiles, BrokenLinesAreNamed) {
  const std::string header = "start\tend\tphone\tviseme\tprominence\tclosure_start\tclosure_end\n";
  const auto why = [&](const std::string& line) {
    const auto read = parse_phones(header + line, "p.tsv");
    return read.has_value() ? std::string("no error") : read.error().message();
  };
  EXPECT_EQ(why("0.1\t0.2\taa\tAA\t1\t-\t-\n"), "no error");
  for (const std::string line :
       {"0.1\t0.2\taa\tAA\t1\t-", "0.1\t0.2\taa\tAA\t1\t-\t-\t-", "x\t0.2\taa\tAA\t1\t-\t-",
        "0.1\t0.05\taa\tAA\t1\t-\t-", "-1\t0.2\taa\tAA\t1\t-\t-", "0.1\tnan\taa\tAA\t1\t-\t-",
        "0.1\tinf\taa\tAA\t1\t-\t-", "0.1\t1e300\taa\tAA\t1\t-\t-", "0.1\t0.2\taa\tQQ\t1\t-\t-",
        "0.1\t0.2\taa\tAA+\t1\t-\t-", "0.1\t0.2\taa\tAA\t99\t-\t-", "0.1\t0.2\tp\tPP\t1\t0.15\t-",
        "0.1\t0.2\tp\tPP\t1\t0.15\t0.12", ""})
    EXPECT_NE(why(line + "\n").find("p.tsv, line 2"), std::string::npos) << line << ": " << why(line + "\n");
  EXPECT_NE(why("0.5\t0.6\taa\tAA\t1\t-\t-\n0.1\t0.2\taa\tAA\t1\t-\t-\n").find("line 3"), std::string::npos);
  EXPECT_FALSE(parse_phones("", "p.tsv").has_value());
  EXPECT_FALSE(parse_phones("start\tend\n", "p.tsv").has_value());
  EXPECT_FALSE(parse_accents("0.5\nx\n", "a.txt").has_value());
  EXPECT_FALSE(parse_accents("0.5\t1\n", "a.txt").has_value());
}

TEST(CorpusFiles, IdsCannotLeaveTheFolder) {
  for (const char* id : {"", ".", "..", ".x", "a/b", "../a", "a\\b", "a b", "ä"})
    EXPECT_FALSE(is_valid_item_id(id)) << id;
  EXPECT_FALSE(is_valid_item_id(std::string(300, 'a')));
  EXPECT_TRUE(is_valid_item_id("E1-000_f2.7"));
  std::string text = format_items(std::vector{item_of("good", synthetic_utterance(2, 1))});
  text.replace(text.find("good"), 4, "../x");
  EXPECT_FALSE(parse_items(text, "items.tsv").has_value());
}

TEST(CorpusFiles, InfoRoundTripAndErrors) {
  const CorpusInfo info{.seed = 0xfedcba9876543210u,
                        .channels = {"jawOpen", "x"},
                        .engines = {{"flite", "2.2"}},
                        .generator_hash = generator_hash(),
                        .items_of_split = {{"train", 3}, {"valid", 1}}};
  const std::string text = format_info(info);
  const auto back = parse_info(text, "corpus.json");
  ASSERT_TRUE(back.has_value()) << back.error().message();
  EXPECT_EQ(back->seed, info.seed);
  EXPECT_EQ(back->generator_hash, info.generator_hash);
  EXPECT_EQ(back->channels, info.channels);
  EXPECT_EQ(back->engines, info.engines);
  EXPECT_EQ(back->items_of_split, info.items_of_split);
  for (std::size_t n = 0; n + 2 < text.size(); ++n)
    ASSERT_FALSE(parse_info(text.substr(0, n), "corpus.json").has_value()) << n;
  Rng rng(3);
  for (int i = 0; i < 3000; ++i) {  // any answer but a crash
    std::string broken = text;
    broken[rng.below(broken.size())] = static_cast<char>(rng.below(256));
    (void)parse_info(broken, "corpus.json");
  }
}

TEST(CorpusFiles, FlippedBytesInTablesNeverCrash) {
  const Utterance utterance = synthetic_utterance(5, 3);
  const std::string phones = format_phones(utterance.phones);
  const std::string items = format_items(std::vector{item_of("a", utterance)});
  Rng rng(4);
  for (int i = 0; i < 3000; ++i) {
    std::string a = phones, b = items;
    a[rng.below(a.size())] = static_cast<char>(rng.below(256));
    b[rng.below(b.size())] = static_cast<char>(rng.below(256));
    const auto read = parse_phones(a, "p.tsv");
    if (read && i % 30 == 0) {  // what is accepted can be performed
      const Utterance said{*read, {}, 6, false};
      EXPECT_EQ(draw_take(said, fixed_speakers()[0], Emotion::neutral, 1, 1).motion.num_frames(), 360);
    }
    (void)parse_items(b, "items.tsv");
  }
}

class CorpusFolder : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("mien_corpus_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    round_to_file(utterance_);
    item_ = item_of("one", utterance_);
    ASSERT_TRUE(write_utterance(folder_, item_.id, utterance_).has_value());
    ASSERT_TRUE(write_index(folder_, info_, std::vector{item_}).has_value());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] Motion drawn(std::uint64_t k) const {
    return draw_take(utterance_, *find_speaker("S04"), Emotion::happy, 0.65f, take_seed(info_.seed, "one", k))
        .motion;
  }

  std::filesystem::path folder_;
  Utterance utterance_ = synthetic_utterance(4, 9);
  CorpusItem item_;
  CorpusInfo info_{.seed = 7, .channels = arkit_and_head_channels(), .generator_hash = generator_hash()};
};

TEST_F(CorpusFolder, CurvesAreDrawnAgainWhenNotStored) {
  const auto corpus = CorpusReader::open(folder_);
  ASSERT_TRUE(corpus.has_value()) << corpus.error().message();
  ASSERT_EQ(corpus->items().size(), 1u);
  const auto takes = corpus->takes(corpus->items()[0], 2);
  ASSERT_TRUE(takes.has_value()) << takes.error().message();
  EXPECT_FALSE(takes->mean);
  EXPECT_EQ(takes->takes[0].values, drawn(0).values);
  EXPECT_EQ(takes->takes[1].values, drawn(1).values);
  EXPECT_TRUE(corpus->takes(corpus->items()[0], 0)->takes.empty());
}

TEST_F(CorpusFolder, StoredCurvesComeFirstAndMissingTakesAreDrawn) {
  std::vector<Motion> stored = {drawn(0), drawn(0)};
  stored[0].values.assign(stored[0].values.size(), 0.5f);  // the mean
  std::filesystem::create_directories(folder_ / "curves");
  ASSERT_TRUE(
      write_curves(curve_path(folder_, "one"), curve_set(stored, true), CurvePrecision::half).has_value());
  const auto corpus = CorpusReader::open(folder_);
  const auto takes = corpus->takes(corpus->items()[0], 2);
  ASSERT_TRUE(takes.has_value()) << takes.error().message();
  ASSERT_TRUE(takes->mean);
  EXPECT_EQ(takes->mean->values[5], 0.5f);
  ASSERT_EQ(takes->takes.size(), 2u);
  EXPECT_NE(takes->takes[0].values, drawn(0).values) << "stored as half floats";
  for (std::size_t i = 0; i < takes->takes[0].values.size(); ++i)
    ASSERT_NEAR(takes->takes[0].values[i], stored[1].values[i], 0.01);
  EXPECT_EQ(takes->takes[1].values, drawn(1).values);
}

TEST_F(CorpusFolder, OtherGeneratorIsRefusedUnlessCurvesAreStored) {
  info_.generator_hash ^= 1;
  ASSERT_TRUE(write_index(folder_, info_, std::vector{item_}).has_value());
  const auto corpus = CorpusReader::open(folder_);
  const auto takes = corpus->takes(corpus->items()[0], 1);
  ASSERT_FALSE(takes.has_value());
  EXPECT_EQ(takes.error().code, Errc::incompatible);
  std::filesystem::create_directories(folder_ / "curves");
  const std::vector stored = {drawn(0)};
  ASSERT_TRUE(
      write_curves(curve_path(folder_, "one"), curve_set(stored, false), CurvePrecision::single).has_value());
  EXPECT_EQ(corpus->takes(corpus->items()[0], 1)->takes[0].values, stored[0].values);
}

TEST_F(CorpusFolder, MissingAndContradictingFilesAreErrors) {
  EXPECT_FALSE(CorpusReader::open(folder_ / "nowhere").has_value());
  const auto corpus = CorpusReader::open(folder_);
  const CorpusItem& item = corpus->items()[0];
  std::filesystem::create_directories(folder_ / "curves");
  Motion shorter = drawn(0);
  shorter.values.resize(shorter.values.size() - 55);
  ASSERT_TRUE(write_curves(curve_path(folder_, "one"), curve_set({&shorter, 1}, false), CurvePrecision::half)
                  .has_value());
  EXPECT_FALSE(corpus->takes(item, 1).has_value());
  std::filesystem::remove(curve_path(folder_, "one"));
  CorpusItem stranger = item;
  stranger.speaker = "S99";
  EXPECT_FALSE(corpus->takes(stranger, 1).has_value());
  std::filesystem::remove(folder_ / "accents" / "one.txt");
  EXPECT_FALSE(corpus->takes(item, 1).has_value());
  EXPECT_FALSE(corpus->utterance(item).has_value());
}

}  // namespace
}  // namespace mien
