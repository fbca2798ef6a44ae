#include "build.h"

#include <gtest/gtest.h>
#include <sndfile.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "audio_file.h"
#include "mien/base/file.h"
#include "mien/corpus/corpus_reader.h"
#include "mien/corpus/text.h"
#include "test_folder.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

BuildOptions options_of(CorpusSplit split, const std::string& voice, int clips) {
  BuildOptions o;
  o.plan.split = split;
  o.plan.voices = {voice};
  o.plan.clips = clips;
  o.takes = 2;
  return o;
}

std::map<std::string, Bytes> files_of(const fs::path& folder) {
  std::map<std::string, Bytes> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[fs::relative(entry.path(), folder).string()] = *read_file(entry.path());
  return files;
}

TEST(BuildPlan, UsesItsVoicesSentencesAndStyles) {
  for (const auto& name : split_names()) {
    BuildPlanOptions o;
    o.split = *parse_split(name);
    o.clips = 30;
    o.emotional_share = 1.0 / 3;
    const auto items = plan_build(o);
    if (!items.has_value() && items.error().code == Errc::failed) continue;  // its engines are absent
    ASSERT_TRUE(items.has_value()) << items.error().message();
    ASSERT_EQ(items->size(), 30u);
    int emotional = 0;
    for (const auto& item : *items) {
      emotional += item.plan.emotion != Emotion::neutral ? 1 : 0;
      ASSERT_EQ(item.plan.texts.size(), 1u);
      const bool is_test = name.starts_with("test");
      EXPECT_EQ(split_of_text(item.plan.texts[0]) == TextSplit::test, is_test) << item.plan.texts[0];
      EXPECT_EQ(item.speaker >= "S12", name == "test-voice") << item.speaker;
      const bool is_held_out = std::any_of(held_out_variants().begin(), held_out_variants().end(),
                                           [&](const auto& v) { return item.plan.voice.ends_with("+" + v); });
      EXPECT_EQ(is_held_out || item.plan.voice == "slt", name == "test-voice") << item.plan.voice;
      EXPECT_EQ(item.plan.engine == EngineId::festival, name == "test-engine");
    }
    EXPECT_EQ(emotional, 10);
  }
}

TEST(BuildPlan, RefusesVoicesOfOtherSplits) {
  BuildPlanOptions o;
  o.split = CorpusSplit::test_sentence;
  o.voices = {"flite:slt"};
  ASSERT_FALSE(plan_build(o).has_value());
  EXPECT_EQ(plan_build(o).error().code, Errc::usage);
}

TEST(Build, FolderIsReadBackAndItsCurvesAreThoseOfThePhones) {
  if (find_engine(EngineId::flite) == nullptr) GTEST_SKIP() << "flite is absent";
  const TestFolder folder;
  Progress silent;
  auto o = options_of(CorpusSplit::test_sentence, "flite:kal16", 3);
  o.store = Store::curves;
  const auto built = build_corpus(folder / "c", o, silent);
  ASSERT_TRUE(built.has_value()) << built.error().message();
  EXPECT_EQ(built->clips, 3);
  const auto reader = CorpusReader::open(folder / "c");
  ASSERT_TRUE(reader.has_value()) << reader.error().message();
  ASSERT_EQ(reader->items().size(), 3u);
  for (const auto& item : reader->items()) {
    SF_INFO info{};
    SNDFILE* sound = sf_open(reader->audio_path(item).c_str(), SFM_READ, &info);
    ASSERT_NE(sound, nullptr);
    sf_close(sound);
    EXPECT_NEAR(static_cast<double>(info.frames) / 16000, item.seconds, 1e-9);
    const auto stored = reader->takes(item, 2);
    ASSERT_TRUE(stored.has_value());
    EXPECT_TRUE(stored->mean.has_value());
    fs::remove(curve_path(folder / "c", item.id));
    const auto drawn = reader->takes(item, 2);
    ASSERT_TRUE(drawn.has_value()) << drawn.error().message();
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t i = 0; i < drawn->takes[k].values.size(); ++i)
        ASSERT_EQ(stored->takes[k].values[i], half_to_float(float_to_half(drawn->takes[k].values[i])));
  }
}

TEST(Build, SerialAndParallelGiveTheSameFilesAndSeedsDiffer) {
  if (find_engine(EngineId::espeak) == nullptr) GTEST_SKIP() << "espeak is absent";
  const TestFolder folder;
  Progress silent;
  auto o = options_of(CorpusSplit::test_voice, "espeak", 5);
  ASSERT_TRUE(build_corpus(folder / "a", o, silent).has_value());
  o.jobs = 3;
  ASSERT_TRUE(build_corpus(folder / "b", o, silent).has_value());
  EXPECT_TRUE(files_of(folder / "a") == files_of(folder / "b"));
  EXPECT_EQ(files_of(folder / "a").size(), 2 + 3 * 5u);
  o.plan.seed = 2;
  ASSERT_TRUE(build_corpus(folder / "c", o, silent).has_value());
  EXPECT_FALSE(files_of(folder / "a") == files_of(folder / "c"));
}

TEST(Build, NoiseLeavesThePhonesAlone) {
  if (find_engine(EngineId::flite) == nullptr) GTEST_SKIP() << "flite is absent";
  const TestFolder folder;
  Progress silent;
  auto o = options_of(CorpusSplit::test_voice, "flite:slt", 1);
  ASSERT_TRUE(build_corpus(folder / "clean", o, silent).has_value());
  o.reverb_rt60_s = 0.35;
  o.noise_snr_db = 10;
  o.flac = true;
  ASSERT_TRUE(build_corpus(folder / "noisy", o, silent).has_value());
  const auto clean = files_of(folder / "clean"), noisy = files_of(folder / "noisy");
  EXPECT_TRUE(clean.at("phones/test-voice-0000.tsv") == noisy.at("phones/test-voice-0000.tsv"));
  EXPECT_TRUE(noisy.contains("audio/test-voice-0000.flac"));
  const auto reader = CorpusReader::open(folder / "noisy");
  ASSERT_TRUE(reader.has_value());
  EXPECT_EQ(reader->audio_path(reader->items()[0]).extension(), ".flac");
}

TEST(Build, StopsAtItsLimitAndLeavesNothingBehindOnErrors) {
  if (find_engine(EngineId::flite) == nullptr) GTEST_SKIP() << "flite is absent";
  const TestFolder folder;
  Progress silent;
  auto o = options_of(CorpusSplit::valid, "flite:kal16", 6);
  o.store = Store::items;
  o.limit_seconds = 9;
  const auto built = build_corpus(folder / "c", o, silent);
  ASSERT_TRUE(built.has_value());
  EXPECT_LE(built->seconds, 9);
  EXPECT_LT(built->clips, 6);
  EXPECT_EQ(build_corpus(folder / "c", o, silent).error().code, Errc::usage)
      << "an existing folder is not overwritten";
  o.limit_seconds = 0.1;
  EXPECT_FALSE(build_corpus(folder / "d", o, silent).has_value());
  Progress cancelled;
  cancelled.cancel();
  EXPECT_EQ(build_corpus(folder / "e", o, cancelled).error().code, Errc::cancelled);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(AudioFile, KeepsSixteenBitsAndClips) {
  const TestFolder folder;
  for (const char* name : {"x.wav", "x.flac"}) {
    ASSERT_TRUE(write_audio(folder / name, std::vector<float>{0.0f, 0.5f, -2.0f, 1.5f}).has_value());
    SF_INFO info{};
    SNDFILE* file = sf_open((folder / name).c_str(), SFM_READ, &info);
    ASSERT_NE(file, nullptr);
    std::vector<short> back(4);
    EXPECT_EQ(sf_read_short(file, back.data(), 4), 4);
    sf_close(file);
    EXPECT_EQ(back, (std::vector<short>{0, 16384, -32768, 32767}));
    EXPECT_EQ(info.samplerate, 16000);
  }
  EXPECT_FALSE(write_audio(folder / "no/such.wav", std::vector<float>{0.0f}).has_value());
}

}  // namespace
}  // namespace mien
