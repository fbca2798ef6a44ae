#include "prepare.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <set>

#include "forked.h"
#include "mien/base/file.h"
#include "set_check.h"
#include "set_writer.h"
#include "test_folder.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

Bytes text_bytes(const std::string& text) {
  const auto b = as_bytes(text);
  return {b.begin(), b.end()};
}

TEST(Forked, ResultsComeInOrderWhateverTheNumberOfProcesses) {
  for (const int jobs : {1, 2, 7}) {
    std::vector<std::string> got;
    const auto done = run_forked(
        jobs, 23,
        [](std::int64_t i) -> Result<Bytes> {
          if (i % 5 == 0) ::usleep(3000);
          if (i == 7) return Error{Errc::failed, "seven", "is refused", ""};
          if (i == 9) ::raise(SIGKILL);
          return text_bytes(std::string(static_cast<std::size_t>(i) * 10000, 'x') + std::to_string(i));
        },
        [&](std::int64_t i, Result<Bytes> bytes) -> Status {
          EXPECT_EQ(i, static_cast<std::int64_t>(got.size()));
          got.push_back(bytes.has_value() ? std::string(as_text(*bytes)) : bytes.error().message());
          return Done{};
        });
    ASSERT_TRUE(done.has_value());
    ASSERT_EQ(got.size(), 23u);
    EXPECT_EQ(got[3].size(), 30001u);
    EXPECT_EQ(got[7], "item 7: seven: is refused");
    EXPECT_EQ(got[9], "item 9: its process died of signal 9");
  }
}

TEST(Forked, StopsWhenTheResultIsRefused) {
  int taken = 0;
  const auto done = run_forked(
      2, 100, [](std::int64_t) -> Result<Bytes> { return Bytes{}; },
      [&](std::int64_t, Result<Bytes>) -> Status {
        if (++taken == 3) return Error{Errc::cancelled, "test", "enough", ""};
        return Done{};
      });
  ASSERT_FALSE(done.has_value());
  EXPECT_EQ(done.error().code, Errc::cancelled);
  EXPECT_EQ(taken, 3);
}

PrepareSetOptions small_options() {
  PrepareSetOptions o;
  o.plan.hours = 0.03;
  o.plan.seed = 4;
  o.plan.valid_share = 0.2;
  return o;
}

TEST(Plan, KeepsTestSentencesAndTestVoicesOut) {
  if (available_engines().empty()) GTEST_SKIP() << "no engine is present";
  std::vector<std::string> missing;
  const auto items = plan_training({0.3, 4, 0.2}, missing);
  int valid = 0, emotional = 0, speaking = 0, quiet = 0;
  std::set<std::string> train_texts, valid_texts;
  for (const auto& item : items) {
    EXPECT_NE(item.engine, EngineId::festival);
    EXPECT_NE(item.voice, "slt");
    for (const auto& variant : held_out_variants())
      EXPECT_FALSE(item.voice.ends_with("+" + variant)) << item.voice;
    if (item.non_speech != NonSpeech::none) {
      ++quiet;
      continue;
    }
    ++speaking;
    valid += item.split == TextSplit::valid ? 1 : 0;
    emotional += item.emotion != Emotion::neutral ? 1 : 0;
    EXPECT_EQ(item.level == 0, item.emotion == Emotion::neutral);
    for (const auto& text : item.texts) {
      EXPECT_EQ(split_of_text(text), item.split) << text;
      (item.split == TextSplit::valid ? valid_texts : train_texts).insert(text);
    }
  }
  EXPECT_GT(valid, 0);
  EXPECT_GT(train_texts.size(), 100u);
  for (const auto& text : valid_texts) EXPECT_FALSE(train_texts.contains(text)) << text;
  EXPECT_NEAR(emotional / static_cast<double>(speaking), 0.5, 0.2);
  EXPECT_GE(quiet, 1);
}

TEST(Prepare, SerialAndParallelGiveTheSameFile) {
  if (find_engine(EngineId::espeak) == nullptr || find_engine(EngineId::flite) == nullptr)
    GTEST_SKIP() << "espeak or flite is absent";
  const TestFolder folder;
  Progress silent;
  auto options = small_options();
  const auto serial = prepare_set(folder / "a.safetensors", options, silent);
  ASSERT_TRUE(serial.has_value()) << serial.error().message();
  EXPECT_EQ(serial->skipped, 0);
  EXPECT_EQ(serial->entries, 2 * serial->items);
  options.jobs = 3;
  ASSERT_TRUE(prepare_set(folder / "b.safetensors", options, silent).has_value());
  EXPECT_TRUE(*read_file(folder / "a.safetensors") == *read_file(folder / "b.safetensors"));
  options.plan.seed = 5;
  ASSERT_TRUE(prepare_set(folder / "c.safetensors", options, silent).has_value());
  EXPECT_FALSE(*read_file(folder / "a.safetensors") == *read_file(folder / "c.safetensors"));
  for (const auto& entry : fs::directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().extension(), ".safetensors");

  const auto statistics = check_set(folder / "a.safetensors");
  ASSERT_TRUE(statistics.has_value()) << statistics.error().message();
  EXPECT_NEAR(statistics->hours, 2 * serial->distinct_hours, 0.001);
  EXPECT_GT(statistics->closure_dip, -8.0);
  EXPECT_LT(statistics->closure_dip, -0.5) << "closures are not where the sound is weak";
  EXPECT_GT(statistics->sealed_share, 0.98);
  EXPECT_NEAR(statistics->blinks_per_minute, 22, 7);
  EXPECT_NEAR(statistics->raises_per_minute, 12, 7);  // 24 % of about one accent a second of speech
}

TEST(Prepare, EntryFollowsThePhones) {
  Utterance spoken;
  PhoneSegment p;
  p.start_s = 0.5, p.end_s = 0.6, p.label = "p", p.visemes = {Viseme::PP, {}},
  p.closure = TimeSpan{0.52, 0.58};
  spoken.phones.push_back(p);
  p = {};
  p.start_s = 0.6, p.end_s = 0.8, p.label = "ay", p.visemes = {Viseme::AA, Viseme::IH};
  spoken.phones.push_back(p);
  spoken.seconds = 1.0;
  spoken.accents_s = {0.7};
  ItemPlan item;
  item.emotion = Emotion::angry;
  item.level = 2;
  const auto e = make_entry(std::vector<float>(16000, 0.0f), spoken, item, 2, 1, "x");
  EXPECT_EQ(e.num_mel(), 101);
  ASSERT_EQ(e.num_frames(), 60);
  EXPECT_EQ(e.viseme[29], static_cast<int>(Viseme::sil));
  EXPECT_EQ(e.viseme[30], static_cast<int>(Viseme::PP));
  EXPECT_EQ(e.viseme[36], static_cast<int>(Viseme::AA));
  EXPECT_EQ(e.viseme[42], static_cast<int>(Viseme::AA));
  EXPECT_EQ(e.viseme[43], static_cast<int>(Viseme::IH));
  EXPECT_EQ(e.viseme[48], static_cast<int>(Viseme::sil));
  EXPECT_EQ(std::vector<int>(e.closure.begin() + 31, e.closure.begin() + 36),
            (std::vector<int>{0, 1, 1, 1, 0}));
  EXPECT_EQ(e.accent[42], 1);
  EXPECT_FLOAT_EQ(e.intensity, 0.65f);
  EXPECT_EQ(e.takes.size(), 2u);
  EXPECT_NE(e.takes[0].curves, e.takes[1].curves);
}

TEST(Prepare, EntriesSurviveTheirBytesAndCutBytesDoNot) {
  ItemPlan item;
  Utterance spoken;
  spoken.seconds = 0.05;
  Bytes bytes;
  append_entry(bytes, make_entry(std::vector<float>(800, 0.1f), spoken, item, 1, 1, "x"));
  const auto back = parse_entries(bytes);
  ASSERT_TRUE(back.has_value());
  ASSERT_EQ(back->size(), 1u);
  Bytes again;
  append_entry(again, back->front());
  EXPECT_EQ(again, bytes);
  for (std::size_t n = 1; n < bytes.size(); ++n)
    ASSERT_FALSE(parse_entries(std::span(bytes).first(n)).has_value()) << n;
}

TEST(Prepare, WriterRefusesAnEmptySetAndAMissingFolder) {
  const TestFolder folder;
  Progress silent;
  auto writer = SetWriter::create(folder / "empty.safetensors", 1);
  ASSERT_TRUE(writer.has_value());
  EXPECT_FALSE(writer->finish({}, silent).has_value());
  EXPECT_FALSE(SetWriter::create(folder / "no/such/set.safetensors", 1).has_value());
}

TEST(Check, NamesWhatIsWrong) {
  const TestFolder folder;
  EXPECT_EQ(check_set(folder / "missing.safetensors").error().code, Errc::input);
  ItemPlan item;
  Utterance spoken;
  spoken.seconds = 0.5;
  Progress silent;
  const auto write = [&](auto spoil) {
    auto entry = make_entry(std::vector<float>(8000, 0.1f), spoken, item, 1, 1, "x");
    spoil(entry);
    auto writer = SetWriter::create(folder / "set.safetensors", 1);
    EXPECT_TRUE(writer->add(entry).has_value());
    EXPECT_TRUE(writer->finish({}, silent).has_value());
    return check_set(folder / "set.safetensors");
  };
  EXPECT_TRUE(write([](auto&) {}).has_value());
  constexpr std::uint16_t kNan = 0x7e00, kTwo = 0x4000;
  EXPECT_EQ(write([](auto& e) { e.mel[5] = kNan; }).error().what, "tensor 'mel'");
  EXPECT_EQ(write([](auto& e) { e.takes[0].curves[17] = kTwo; }).error().what, "tensor 'curves'");
  EXPECT_EQ(write([](auto& e) { e.viseme[3] = 28; }).error().what, "tensor 'viseme'");
  EXPECT_EQ(write([](auto& e) { e.emotion = 8; }).error().what, "tensor 'emotion'");
}

}  // namespace
}  // namespace mien
