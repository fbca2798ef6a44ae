#include <gtest/gtest.h>

#include <string>

#include "mien/metrics/benchmark_set.h"
#include "mien/metrics/speech_labels.h"

namespace mien {
namespace {

const std::string kHeader = "start\tend\tphone\tviseme\tclosure_start\tclosure_end\tconfidence\tflags\n";
const std::string kTable = kHeader +
                           "0.0000\t0.4000\tsil\tsil\t-\t-\t0.95\tnot_quiet\n"
                           "0.4000\t0.5000\tm\tPP\t0.4040\t0.4960\t0.85\tmerged,edge_start\n"
                           "0.5000\t0.6000\tp\tPP\t0.4040\t0.4960\t0.85\tmerged,same_event_as_previous\n"
                           "0.6000\t0.9000\tay\tAA+IH\t-\t-\t0.90\t-\n";

TEST(SpeechLabels, ReadsTimesClosuresAndFlags) {
  const auto labels = parse_speech_labels(kTable, "x");
  ASSERT_TRUE(labels) << labels.error().message();
  ASSERT_EQ(labels->rows.size(), 4u);
  EXPECT_DOUBLE_EQ(labels->seconds(), 0.9);
  EXPECT_TRUE(labels->rows[0].is_silence());
  EXPECT_EQ(labels->rows[0].flags, kNotQuiet);
  EXPECT_EQ(labels->rows[1].flags, kMerged | kEdgeStart);
  ASSERT_TRUE(labels->rows[1].closure);
  EXPECT_DOUBLE_EQ(labels->rows[1].closure->centre(), 0.45);
  EXPECT_EQ(labels->rows[2].flags, kMerged | kSameEvent);
  EXPECT_FALSE(labels->rows[3].closure);
  const auto rows = labels->rows_of_frames(60, 60);
  EXPECT_EQ(rows[0], 0u);
  EXPECT_EQ(rows[23], 0u);
  EXPECT_EQ(rows[24], 1u);  // t = 0.4: rows are half open
  EXPECT_EQ(rows[59], 3u);  // past the end
}

TEST(SpeechLabels, ToleratesCarriageReturnsAndAMissingLastNewline) {
  std::string text;
  for (const char c : kTable) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  text.pop_back(), text.pop_back();
  const auto labels = parse_speech_labels(text, "x");
  ASSERT_TRUE(labels) << labels.error().message();
  EXPECT_EQ(labels->rows.size(), 4u);
}

TEST(SpeechLabels, NamesTheLineOfEveryKindOfMistake) {
  const auto why = [](const std::string& text) {
    const auto labels = parse_speech_labels(text, "clip");
    return labels ? std::string("accepted") : labels.error().message();
  };
  EXPECT_NE(why("").find("line 1"), std::string::npos);
  EXPECT_NE(why(kHeader).find("no rows"), std::string::npos);
  EXPECT_NE(why(kHeader + "0\t1\ta\tA\t-\t-\t1\n").find("7 columns"), std::string::npos);
  EXPECT_NE(why(kHeader + "0\tx\ta\tA\t-\t-\t1\t-\n").find("times"), std::string::npos);
  EXPECT_NE(why(kHeader + "0\tnan\ta\tA\t-\t-\t1\t-\n").find("times"), std::string::npos);
  EXPECT_NE(why(kHeader + "0\tinf\ta\tA\t-\t-\t1\t-\n").find("times"), std::string::npos);
  EXPECT_NE(why(kHeader + "0\t1e300\ta\tA\t-\t-\t1\t-\n").find("times"), std::string::npos);
  EXPECT_NE(why(kHeader + "0.2\t0.1\ta\tA\t-\t-\t1\t-\n").find("ends before"), std::string::npos);
  EXPECT_NE(why(kHeader + "0.5\t1\ta\tA\t-\t-\t1\t-\n").find("contiguous"), std::string::npos);
  EXPECT_NE(why(kHeader + "0\t1\ta\tA\t0.1\t-\t1\t-\n").find("closure"), std::string::npos);
  EXPECT_NE(why(kHeader + "0\t1\ta\tA\t-\t-\tnan\t-\n").find("confidence"), std::string::npos);
  EXPECT_NE(why(kHeader + "0\t1\t\tA\t-\t-\t1\t-\n").find("no phone"), std::string::npos);
  EXPECT_NE(why(kHeader + "0\t1\ta\tA\t-\t-\t1\tloud\n").find("'loud'"), std::string::npos);
}

TEST(SpeechLabels, SurvivesEveryTruncationAndFlippedByte) {
  for (std::size_t n = 0; n < kTable.size(); ++n) {
    const std::string cut(kTable.begin(), kTable.begin() + static_cast<std::ptrdiff_t>(n));
    (void)parse_speech_labels(cut, "x");  // an Error or the rows so far: both are fine, a crash is not
    for (const int mask : {0x01, 0x08, 0x40, 0xff}) {
      std::string flipped = kTable;
      flipped[n] = static_cast<char>(flipped[n] ^ mask);
      const auto labels = parse_speech_labels(flipped, "x");
      if (labels) {
        EXPECT_LE(labels->rows.size(), 5u);
      }
    }
  }
}

TEST(SpeechLabels, WarnsOfAReversedClosure) {
  const auto labels = parse_speech_labels(kHeader + "0\t1\tp\tPP\t0.5\t0.4\t0.3\tdoubtful\n", "x");
  ASSERT_TRUE(labels);
  EXPECT_EQ(labels.warnings.size(), 1u);
}

std::string clip_json(const std::string& id, const std::string& file) {
  return R"({"id":")" + id + R"(","file":")" + file +
         R"(","labels":"labels/a.tsv","language":"en","speaker":"s","style":"noisy","seconds":1.5})";
}

TEST(BenchmarkSet, ReadsClipsAndFindsTheCleanCopy) {
  const auto clips = parse_benchmark(
      R"({"clips":[)" + clip_json("a", "a.flac") + "," + clip_json("a_noisy", "b.flac") + "]}", "/set");
  ASSERT_TRUE(clips) << clips.error().message();
  ASSERT_EQ(clips->size(), 2u);
  EXPECT_EQ((*clips)[1].clean_id, "a");
  EXPECT_EQ((*clips)[0].clean_id, "a");
  EXPECT_EQ((*clips)[0].audio, std::filesystem::path("/set/a.flac"));
  EXPECT_TRUE(belongs_to((*clips)[1], SpeechGroup::noisy));
  EXPECT_FALSE(belongs_to((*clips)[1], SpeechGroup::english_clean));
}

TEST(BenchmarkSet, RefusesManifestsThatAreBrokenOrReachOutside) {
  for (const std::string& text :
       {std::string(""), std::string("[]"), std::string("{}"), std::string(R"({"clips":3})"),
        std::string(R"({"clips":[3]})"), std::string(R"({"clips":[{"id":"a"}]})"),
        R"({"clips":[)" + clip_json("a", "../a.flac") + "]}",
        R"({"clips":[)" + clip_json("a", "/etc/a") + "]}", R"({"clips":[)" + clip_json("", "a") + "]}",
        R"({"clips":[)" + clip_json("a", "a") + "," + clip_json("a", "a") + "]}"})
    EXPECT_FALSE(parse_benchmark(text, "/set")) << text;
  const std::string good = R"({"clips":[)" + clip_json("a", "a.flac") + "]}";
  for (std::size_t n = 0; n < good.size(); ++n) EXPECT_FALSE(parse_benchmark(good.substr(0, n), "/set"));
  EXPECT_FALSE(read_benchmark("/nowhere/at/all"));
  EXPECT_FALSE(parse_benchmark(std::string(200000, '['), "/set"));
}

}  // namespace
}  // namespace mien
