#include "mien/metrics/synthetic_benchmark.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "mien/base/hash.h"
#include "mien/base/random.h"
#include "mien/corpus/take.h"
#include "mien/metrics/utterance_labels.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

// Phrases of random phones between pauses, an accent every 0.7 s of speech.
Utterance babble(double seconds, std::uint64_t seed) {
  static constexpr const char* kPhones[] = {"p", "aa", "t", "iy", "m", "ow", "s", "eh",
                                            "f", "uw", "b", "ae", "n", "ay", "l", "ah"};
  Rng rng(seed);
  Utterance u;
  double t = 0;
  const auto add = [&](const std::string& label, double length) {
    PhoneSegment phone{t, t + length, label, *visemes_of_arpabet(label)};
    if (phone.is_bilabial()) phone.closure = default_closure(phone);
    u.phones.push_back(phone);
    t += length;
  };
  add("pau", 0.35);
  while (t < seconds - 0.8) {
    const double phrase_end = t + rng.uniform(1.2, 2.2);
    for (std::uint64_t i = rng.below(16); t < phrase_end && t < seconds - 0.5;
         i = (i + 1 + 2 * rng.below(4)) % 16) {
      if (u.accents_s.empty() || t > u.accents_s.back() + 0.7) u.accents_s.push_back(t + 0.05);
      add(kPhones[i], rng.uniform(0.06, 0.13));
    }
    add("pau", rng.uniform(0.35, 0.6));
  }
  u.seconds = t;
  round_to_file(u);
  return u;
}

// A corpus in a folder that goes away with the test.
class CorpusFolder {
 public:
  CorpusFolder(int num_items, double seconds)
      : path_(fs::temp_directory_path() / ("mien_metrics_" + std::to_string(::getpid()))) {
    fs::remove_all(path_);
    std::vector<CorpusItem> items;
    for (int i = 0; i < num_items; ++i) {
      const Utterance u = babble(seconds, static_cast<std::uint64_t>(i));
      CorpusItem item;
      item.id = "item" + std::to_string(i);
      item.split = i % 4 == 3 ? "valid" : "test", item.engine = "none", item.voice = "none",
      item.language = "en";
      item.speaker = fixed_speakers()[static_cast<std::size_t>(i % kNumTrainingStyles)].id;
      item.emotion = i % 2 == 0 ? Emotion::neutral : static_cast<Emotion>(1 + i % 7);
      item.level = i % 2 == 0 ? 1 : 1 + i % 3;
      item.seconds = u.seconds, item.num_frames = num_motion_frames(u.seconds, 60), item.text = "babble";
      EXPECT_TRUE(write_utterance(path_, item.id, u));
      items.push_back(item);
    }
    CorpusInfo info;
    info.seed = 5, info.channels = arkit_and_head_channels(), info.generator_hash = generator_hash();
    EXPECT_TRUE(write_index(path_, info, items));
  }
  ~CorpusFolder() { fs::remove_all(path_); }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// Systems that know the phones.
enum class Oracle { right, mean, wrong_emotion, late, restless };
SyntheticSystem oracle(const fs::path& folder, Oracle kind) {
  return [=](const SyntheticRequest& request) -> Result<std::vector<Motion>> {
    MIEN_TRY(const CorpusReader reader, CorpusReader::open(folder));
    MIEN_TRY(Utterance utterance, reader.utterance(request.item));
    const Speaker& speaker = *find_speaker(request.item.speaker);
    Emotion emotion = request.item.emotion;
    if (kind == Oracle::wrong_emotion) emotion = emotion == Emotion::sad ? Emotion::happy : Emotion::sad;
    if (kind == Oracle::late)
      for (PhoneSegment& phone : utterance.phones) {
        phone.start_s += 0.15, phone.end_s += 0.15;
        if (phone.closure) phone.closure->start_s += 0.15, phone.closure->end_s += 0.15;
      }
    std::vector<Motion> out;
    for (const std::uint64_t seed : request.take_seeds) {
      const std::uint64_t used = kind == Oracle::mean ? 1 : seed;
      out.push_back(draw_take(utterance, speaker, emotion, request.item.intensity(), used).motion);
      if (kind == Oracle::mean)
        out.back() = plain_performance(utterance, speaker, emotion, request.item.intensity());
      if (kind != Oracle::restless) continue;
      Rng rng(seed);
      for (float& v : out.back().values) v += static_cast<float>(rng.normal(0, 0.02));
    }
    return out;
  };
}

SyntheticFigures figures_of(const CorpusFolder& corpus, Oracle kind, SyntheticOptions options = {}) {
  Progress progress;
  options.true_takes = std::max(options.true_takes, 16);
  const auto report = evaluate_synthetic(corpus.path(), oracle(corpus.path(), kind), options, progress);
  EXPECT_TRUE(report) << report.error().message();
  return report ? pool_synthetic(report->items) : SyntheticFigures{};
}

TEST(UtteranceLabels, KeepPausesClosuresAndMergeNeighbours) {
  Utterance u;
  const auto add = [&](double start, double end, const char* label) {
    u.phones.push_back({start, end, label, *visemes_of_arpabet(label)});
  };
  add(0.4, 0.5, "m"), add(0.5, 0.6, "p"), add(0.6, 0.8, "aa"), add(0.8, 0.9, "v"), add(0.9, 1.0, "pau"),
      add(1.0, 1.1, "b");
  u.seconds = 1.2;
  const SpeechLabels labels = labels_of(u);
  ASSERT_EQ(labels.rows.size(), 8u);
  EXPECT_EQ(labels.rows[0].phone, "sil");  // the gap before the first phone
  EXPECT_DOUBLE_EQ(labels.rows[0].end, 0.4);
  EXPECT_EQ(labels.rows[4].phone, "f");
  EXPECT_EQ(labels.rows[5].phone, "sp");
  EXPECT_EQ(labels.rows[7].phone, "sp");
  EXPECT_DOUBLE_EQ(labels.seconds(), 1.2);
  const auto events = closure_events(labels);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_FALSE(events[0].timed);
  EXPECT_DOUBLE_EQ(events[0].window.start, default_closure(u.phones[0]).start_s);
  EXPECT_DOUBLE_EQ(events[0].window.end, default_closure(u.phones[1]).end_s);
  EXPECT_TRUE(labels_of({}).rows.empty());
}

TEST(SyntheticBenchmark, TheTruthItselfScoresIdeal) {
  const CorpusFolder corpus(16, 6);
  const SyntheticFigures f = figures_of(corpus, Oracle::right);
  EXPECT_EQ(f.items, 16);
  EXPECT_GT(f.r, 0.96);
  EXPECT_GT(f.jaw_r, 0.97);
  EXPECT_GT(f.closure_hit, 0.97);
  EXPECT_GT(f.rounding_hit, 0.97);
  EXPECT_NEAR(f.rounding_onset_ms, 0, 5);
  EXPECT_GT(f.contact_f1, 0.85);
  EXPECT_NEAR(f.contact_f1, f.contact_f1_truth, 0.03);
  for (std::size_t r = 0; r < kNumFaceRegions; ++r) {
    EXPECT_NEAR(f.diversity[r], 1, 0.12) << r;
    EXPECT_NEAR(f.jitter[r], 1, 0.08) << r;
    EXPECT_NEAR(f.spread_skill[r], 1, 0.25) << r;
    EXPECT_NEAR(f.energy_regret[r], 0, 0.06) << r;
  }
  EXPECT_NEAR(f.blink_rate_ratio, 1, 0.15);
  EXPECT_LT(f.blink_interval_ks, 0.12);
  EXPECT_GT(f.brow_lift_truth, 1.3);
  EXPECT_NEAR(f.brow_lift_ratio, 1, 0.3);
  EXPECT_GT(f.emotion_ceiling, 0.9);
  EXPECT_NEAR(f.emotion_ratio, 1, 0.06);
  EXPECT_GT(f.style_ceiling, 0.5);
  EXPECT_NEAR(f.style, f.style_ceiling, 0.15);
  EXPECT_GT(f.level_ceiling, 0.6);
  EXPECT_LT(f.pause_motion_ratio, 0.15);
}

TEST(SyntheticBenchmark, SeesWhatIsWrongWithASystem) {
  const CorpusFolder corpus(8, 5);
  const SyntheticFigures right = figures_of(corpus, Oracle::right);
  const SyntheticFigures deterministic = figures_of(corpus, Oracle::mean);
  for (const double d : deterministic.diversity) EXPECT_EQ(d, 0);
  EXPECT_EQ(deterministic.blinks, 0);
  EXPECT_GT(deterministic.r, 0.9);
  EXPECT_LT(deterministic.spread_skill[1], 0.01);
  const SyntheticFigures wrong = figures_of(corpus, Oracle::wrong_emotion);
  EXPECT_LT(wrong.emotion, 0.2);
  const SyntheticFigures late = figures_of(corpus, Oracle::late);
  EXPECT_LT(late.jaw_r, right.jaw_r - 0.2);
  EXPECT_LT(late.closure_f1, 0.3);
  EXPECT_GT(late.rounding_onset_ms, 40);
  const SyntheticFigures restless = figures_of(corpus, Oracle::restless);
  EXPECT_GT(restless.jitter[0], 1.5);
  EXPECT_GT(restless.diversity[0], right.diversity[0] * 1.3);
}

TEST(SyntheticBenchmark, DoesNotDependOnThreadsAndKeepsItsSeeds) {
  const CorpusFolder corpus(2, 3);
  const auto table = [&](int threads, std::uint64_t seed) {
    Progress progress;
    SyntheticOptions options;
    options.threads = threads, options.seed = seed, options.samples = 2, options.true_takes = 4;
    const auto report =
        evaluate_synthetic(corpus.path(), oracle(corpus.path(), Oracle::right), options, progress);
    EXPECT_TRUE(report) << report.error().message();
    return to_json(synthetic_table(std::vector<NamedSyntheticReport>{{"es", *report}}, 20));
  };
  const std::string one = table(1, 1);
  EXPECT_EQ(one, table(2, 1));
  EXPECT_EQ(one, table(7, 1));
  EXPECT_NE(one, table(1, 2));
}

TEST(SyntheticBenchmark, ChoosesItemsBySplitAndNumber) {
  const CorpusFolder corpus(8, 2);
  SyntheticOptions options;
  options.samples = 2, options.true_takes = 2;
  Progress progress;
  const auto system = oracle(corpus.path(), Oracle::right);
  options.splits = {"valid"};
  EXPECT_EQ(evaluate_synthetic(corpus.path(), system, options, progress)->items.size(), 2u);
  options.splits = {"nothing"};
  EXPECT_FALSE(evaluate_synthetic(corpus.path(), system, options, progress));
  options.splits = {};
  options.max_items = 3;
  const auto report = evaluate_synthetic(corpus.path(), system, options, progress);
  ASSERT_EQ(report->items.size(), 3u);
  EXPECT_EQ(report->items[1].id, "item2");
}

TEST(SyntheticBenchmark, NamesTheItemOfAFailure) {
  const CorpusFolder corpus(1, 2);
  SyntheticOptions options;
  options.samples = 2, options.true_takes = 2;
  Progress progress;
  const auto message = [&](const SyntheticSystem& system) {
    const auto report = evaluate_synthetic(corpus.path(), system, options, progress);
    return report ? std::string("accepted") : report.error().message();
  };
  const auto with = [&](auto&& change) {
    return [&, change](const SyntheticRequest& request) -> Result<std::vector<Motion>> {
      MIEN_TRY(std::vector<Motion> takes, oracle(corpus.path(), Oracle::right)(request));
      change(takes);
      return takes;
    };
  };
  EXPECT_EQ(message(with([](auto&) {})), "accepted");
  EXPECT_EQ(message(with([](auto& t) { t[0].values.resize(t[0].values.size() - 55 * 5); })), "accepted");
  EXPECT_NE(message(with([](auto& t) { t.pop_back(); })).find("item0"), std::string::npos);
  EXPECT_NE(message(with([](auto& t) { t[1].values[7] = std::nanf(""); })).find("finite"), std::string::npos);
  EXPECT_NE(message(with([](auto& t) { t[1].fps = 30; })).find("60"), std::string::npos);
  EXPECT_NE(message(with([](auto& t) { t[1].values.clear(); })).find("frames"), std::string::npos);
  EXPECT_NE(message(with([](auto& t) { t[1].values.resize(55 * 10); })).find("frames"), std::string::npos);
  EXPECT_NE(message(with([](auto& t) { t[1].channels.pop_back(); })).find("channels"), std::string::npos);
  EXPECT_FALSE(evaluate_synthetic("/nowhere", oracle("/nowhere", Oracle::right), options, progress));
  progress.cancel();
  EXPECT_EQ(
      evaluate_synthetic(corpus.path(), oracle(corpus.path(), Oracle::right), options, progress).error().code,
      Errc::cancelled);
}

}  // namespace
}  // namespace mien
