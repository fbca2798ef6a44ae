#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "mien/base/file.h"
#include "mien/base/random.h"
#include "mien/core/arkit.h"
#include "mien/models/animate.h"
#include "mien/models/default/chunk_code.h"
#include "mien/models/default/face_space.h"
#include "small_model.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

std::vector<float> speech_like(double seconds) {
  std::vector<float> samples(static_cast<std::size_t>(seconds * 16000));
  NoiseField(5, 0).normal(0, 0, samples);
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i] *= static_cast<float>(0.1 * std::max(0.0, std::sin(static_cast<double>(i) / 2500)));
  return samples;
}

std::vector<float> run(const DefaultModel& model, const std::vector<float>& samples, std::size_t piece,
                       const PerformOptions& options = {}) {
  DefaultStream stream(model, options);
  std::vector<float> out;
  std::array<float, 55> frame;
  const auto drain = [&] {
    while (stream.pop(frame)) out.insert(out.end(), frame.begin(), frame.end());
  };
  for (std::size_t at = 0; at < samples.size(); at += piece) {
    stream.push(std::span(samples).subspan(at, std::min(piece, samples.size() - at)));
    drain();
  }
  stream.finish();
  drain();
  return out;
}

TEST(FaceSpace, DecodesWhatItEncodes) {
  std::vector<float> channels(55), face(45), back(55);
  Rng rng(3);
  for (std::size_t c = 0; c < 52; ++c) channels[c] = static_cast<float>(rng.uniform(0.1, 0.9));
  for (const char* name : {"jawLeft", "jawRight", "mouthLeft", "mouthRight"}) channels[arkit_index(name)] = 0;
  for (const char* side : {"Left", "Right"}) {  // gaze to the left and up: both eyes together
    const bool left = std::string_view(side) == "Left";
    channels[arkit_index(std::string("eyeLookOut") + side)] = left ? 0.4f : 0.0f;
    channels[arkit_index(std::string("eyeLookIn") + side)] = left ? 0.0f : 0.4f;
    channels[arkit_index(std::string("eyeLookUp") + side)] = 0.3f;
    channels[arkit_index(std::string("eyeLookDown") + side)] = 0;
  }
  channels[52] = -7;
  encode_face(channels, face);
  decode_face(face, back);
  for (std::size_t c = 0; c < 55; ++c) EXPECT_NEAR(back[c], channels[c], 1e-6) << c;
  face[kFaceJawOpen] = 1.7f;
  decode_face(face, back);
  EXPECT_EQ(back[arkit_index("jawOpen")], 1);
  EXPECT_THROW(decode_face(std::span(face).first(3), back), std::logic_error);
}

TEST(ChunkCode, IsOrthonormalAndInverts) {
  std::vector<float> samples(6 * 20), last(20), coefficients(120), back(120);
  NoiseField(1, 0).normal(0, 0, samples);
  NoiseField(2, 0).normal(0, 0, last);
  default_model::encode_chunk(samples, last, coefficients);
  default_model::decode_chunk(coefficients, last, back);
  double in = 0, out = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_NEAR(back[i], samples[i], 1e-5);
    in += std::pow(samples[i] - last[i % 20], 2);
    out += std::pow(coefficients[i], 2);
  }
  EXPECT_NEAR(in, out, 1e-3);
}

TEST(DefaultStream, GivesTheSameBitsForAnyCutOfTheSound) {
  const DefaultModel model = small_model();
  const auto samples = speech_like(2.3);
  const auto whole = run(model, samples, samples.size());
  EXPECT_EQ(whole.size(), 138u * 55);
  for (const std::size_t piece : {160u, 320u, 1009u, 16000u})
    EXPECT_EQ(run(model, samples, piece), whole) << piece;
}

TEST(DefaultStream, DelaysAFrameByItsLookAheadOnly) {
  const DefaultModel model = small_model();
  const double look_ahead_s = default_model::look_ahead_ms(model.metadata()) / 1000;
  EXPECT_LE(look_ahead_s, 0.2);
  const auto samples = speech_like(2);
  DefaultStream stream(model, {});
  std::array<float, 55> frame;
  std::int64_t count = 0;
  for (std::size_t at = 0; at + 160 <= samples.size(); at += 160) {
    stream.push(std::span(samples).subspan(at, 160));
    while (stream.pop(frame)) ++count;
    const double heard_s = static_cast<double>(at + 160) / 16000;
    // One packet of 10 ms is the grain of this test.
    const auto due = static_cast<std::int64_t>(std::floor((heard_s - look_ahead_s - 0.01) * 60)) + 1;
    EXPECT_GE(count, due) << heard_s;
  }
}

TEST(DefaultStream, HearsNoFurtherThanItsLookAhead) {
  const DefaultModel model = small_model();
  const auto samples = speech_like(2);
  auto changed = samples;
  constexpr std::size_t kChange = 20000;
  for (std::size_t i = kChange; i < changed.size(); ++i) changed[i] = -0.5f * changed[i] + 0.01f;
  const auto a = run(model, samples, samples.size()), b = run(model, changed, changed.size());
  ASSERT_EQ(a.size(), b.size());
  const double unaware_s =
      static_cast<double>(kChange) / 16000 - default_model::look_ahead_ms(model.metadata()) / 1000;
  const auto same = static_cast<std::size_t>(unaware_s * 60) * 55;
  EXPECT_TRUE(std::equal(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(same), b.begin()));
  EXPECT_NE(a, b);
}

TEST(DefaultStream, RaisesTheBrowsAndMovesNothingElseForIt) {
  const fs::path path =
      fs::path(testing::TempDir()) / ("mien_still_brows_" + std::to_string(getpid()) + ".safetensors");
  write_small_model(path, false);
  const auto without = DefaultModel::load(path);
  ASSERT_TRUE(without) << without.error().message();
  const auto samples = speech_like(3);
  const auto a = run(*without, samples, samples.size()), b = run(small_model(), samples, samples.size());
  ASSERT_EQ(a.size(), b.size());
  int raised = 0;
  const auto is_brow = [](std::size_t c) {
    return c == arkit_index("browInnerUp") || c == arkit_index("browOuterUpLeft") ||
           c == arkit_index("browOuterUpRight");
  };
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (is_brow(i % 55)) {
      EXPECT_GE(b[i], a[i]) << i;
      raised += b[i] > a[i] + 0.05f;
    } else {
      ASSERT_EQ(b[i], a[i]) << i;
    }
  }
  EXPECT_GT(raised, 20);
}

TEST(DefaultStream, SeedsChangeTheUpperFaceAndRepeat) {
  const DefaultModel model = small_model();
  const auto samples = speech_like(1.5);
  PerformOptions one, two;
  two.seed = 8;
  EXPECT_EQ(run(model, samples, 4000, two), run(model, samples, 4000, two));
  EXPECT_NE(run(model, samples, 4000, one), run(model, samples, 4000, two));
}

TEST(DefaultStream, EndsWithClosedLipsAndRestsInSilence) {
  const DefaultModel model = small_model();
  const auto spoken = run(model, speech_like(1), 16000);
  const auto last = std::span(spoken).last(55);
  EXPECT_LE(last[arkit_index("jawOpen")] - last[arkit_index("mouthClose")], 1e-6);
  const auto silent = run(model, std::vector<float>(32000, 0.0f), 16000);
  ASSERT_EQ(silent.size(), 120u * 55);
  for (std::size_t n = 0; n < 120; ++n) {
    EXPECT_EQ(silent[n * 55 + arkit_index("jawOpen")], 0) << n;
    for (std::size_t c = 0; c < 55; ++c) EXPECT_TRUE(std::isfinite(silent[n * 55 + c]));
  }
}

TEST(DefaultStream, OneSampleAndNothingAtAllAreNoFrames) {
  const DefaultModel model = small_model();
  EXPECT_TRUE(run(model, {}, 1).empty());
  EXPECT_TRUE(run(model, {0.5f}, 1).empty());
}

TEST(Animate, DoesNotDependOnThreadsAndRefusesShortClips) {
  const DefaultModel model = small_model();
  const fs::path path = fs::path(testing::TempDir()) / "mien_animate.wav";
  const auto samples = speech_like(2.5);
  Bytes wav;
  const auto text = [&](const char* t) {
    for (; *t; ++t) wav.push_back(static_cast<std::byte>(*t));
  };
  const auto bytes = static_cast<std::uint32_t>(samples.size() * 2);
  text("RIFF"), append_le<std::uint32_t>(wav, 36 + bytes), text("WAVEfmt "),
      append_le<std::uint32_t>(wav, 16);
  append_le<std::uint16_t>(wav, 1), append_le<std::uint16_t>(wav, 1), append_le<std::uint32_t>(wav, 16000);
  append_le<std::uint32_t>(wav, 32000), append_le<std::uint16_t>(wav, 2), append_le<std::uint16_t>(wav, 16);
  text("data"), append_le<std::uint32_t>(wav, bytes);
  for (const float s : samples) append_le<std::int16_t>(wav, static_cast<std::int16_t>(s * 32767));
  ASSERT_TRUE(write_file(path, wav));
  std::vector<std::vector<Motion>> results;
  for (const int threads : {1, 2, 7}) {
    auto reader = AudioReader::open(path);
    ASSERT_TRUE(reader) << reader.error().message();
    Progress progress;
    std::vector<Motion> takes(3, empty_default_motion());
    const Status status = animate(model, *reader, {}, 3, threads, progress,
                                  [&](int take, std::span<const float> values) -> Status {
                                    auto& own = takes[static_cast<std::size_t>(take)].values;
                                    own.insert(own.end(), values.begin(), values.end());
                                    return Done{};
                                  });
    ASSERT_TRUE(status) << status.error().message();
    results.push_back(std::move(takes));
  }
  for (int take = 0; take < 3; ++take)
    for (const auto& result : results) EXPECT_EQ(result[take].values, results[0][take].values);
  EXPECT_NE(results[0][0].values, results[0][1].values);
  const auto clip = load_audio(path);
  ASSERT_TRUE(clip);
  Progress progress;
  for (int take = 0; take < 3; ++take) {  // side by side they hear once, and are what they are alone
    PerformOptions own;
    own.seed = performance_seed(own.seed, take);
    EXPECT_EQ(animate(model, *clip, own, progress)->values, results[0][take].values) << take;
  }
  EXPECT_EQ(animate(model, *clip, {}, progress)->values, results[0][0].values);
  EXPECT_EQ(animate(model, AudioClip{{0.1f, 0.2f}, 16000}, {}, progress).error().code, Errc::input);
  progress.cancel();
  EXPECT_EQ(animate(model, *clip, {}, progress).error().code, Errc::cancelled);
}

TEST(DefaultModel, RefusesOtherFilesByName) {
  const fs::path path = fs::path(testing::TempDir()) / "mien_not_a_model.safetensors";
  auto writer = SafetensorsWriter::create(path, {{"a", Dtype::f32, {1}}});
  ASSERT_TRUE(writer->write_float("a", std::vector<float>{1}));
  ASSERT_TRUE(writer->finish());
  const auto refused = DefaultModel::load(path);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::incompatible);
  EXPECT_EQ(DefaultModel::load(path.parent_path() / "none").error().code, Errc::input);

  const fs::path whole = fs::path(testing::TempDir()) / "mien_whole_model.safetensors";
  write_small_model(whole);
  auto metadata = SafetensorsFile::open(whole)->metadata();
  auto& json = metadata.at("mien.model");
  json.replace(json.find("\"width\":16"), 10, "\"width\":18");
  EXPECT_TRUE(default_model::from_metadata(metadata));
  json.replace(json.find("\"width\":18"), 10, "\"width\":-1");
  EXPECT_FALSE(default_model::from_metadata(metadata));
  metadata["mien.model"] = "[";
  EXPECT_EQ(default_model::from_metadata(metadata).error().code, Errc::incompatible);
}

TEST(Direction, InterpolatesAndHoldsItsEnds) {
  const auto direction =
      parse_direction_csv("time,emotion,intensity,style\n1,happy,0.2,S03\n2,angry,3\n2,sad,0.5\n");
  ASSERT_TRUE(direction) << direction.error().message();
  ASSERT_EQ(direction->keys().size(), 2u);
  EXPECT_FLOAT_EQ(direction->strength(0), 0.2f);
  EXPECT_FLOAT_EQ(direction->strength(1.5), 0.85f);
  EXPECT_FLOAT_EQ(direction->strength(9), 1);
  EXPECT_EQ(direction->keys()[0].style, 3);
  EXPECT_EQ(direction->keys()[1].style, -1);
}

TEST(Direction, JsonSaysTheSameAsCsv) {
  const auto csv =
      parse_direction_csv("time,emotion,intensity,style\n1,happy,0.2,S03\n2,angry,3\n2,sad,0.5\n");
  const auto json =
      parse_direction_json(R"([{"time": 1, "emotion": "happy", "intensity": 0.2, "style": "S03"},
      {"time": 2, "emotion": "angry", "intensity": 3}, {"time": 2, "emotion": "sad", "intensity": 0.5}])");
  ASSERT_TRUE(csv && json) << json.error().message();
  ASSERT_EQ(json->keys().size(), csv->keys().size());
  for (std::size_t i = 0; i < json->keys().size(); ++i) {
    EXPECT_EQ(json->keys()[i].seconds, csv->keys()[i].seconds);
    EXPECT_EQ(json->keys()[i].intensities, csv->keys()[i].intensities);
    EXPECT_EQ(json->keys()[i].style, csv->keys()[i].style);
  }
  for (const char* text :
       {"", "[", "{}", "[]", "[1]", R"([{"time":0}])", R"([{"time":0,"emotion":"glad","intensity":1}])",
        R"([{"time":"0","emotion":"sad","intensity":1}])",
        R"([{"time":0,"emotion":"sad","intensity":1,"mood":2}])",
        R"([{"time":1,"emotion":"sad","intensity":1},{"time":0,"emotion":"sad","intensity":1}])"})
    EXPECT_EQ(parse_direction_json(text).error().code, Errc::input) << text;
}

TEST(Direction, NamesTheLineOfAMistake) {
  for (const char* text :
       {"", "x,y,z\n", "time,emotion,intensity\n", "time,emotion,intensity\n-1,happy,1\n",
        "time,emotion,intensity\n0,glad,1\n", "time,emotion,intensity\n0,happy,1.5\n",
        "time,emotion,intensity\n1,happy,1\n0,sad,1\n", "time,emotion,intensity,style\n0,sad,1,S99\n",
        "time,emotion,intensity\n0,nan\n", "time,emotion,intensity\ninf,sad,1\n"})
    EXPECT_EQ(parse_direction_csv(text).error().code, Errc::input) << text;
  EXPECT_NE(
      parse_direction_csv("time,emotion,intensity\n0,happy,1\n1,glad,1\n").error().message().find("line 3"),
      std::string::npos);
  EXPECT_FLOAT_EQ((*parse_emotion_intensity("angry:2"))[6], 0.65f);
  EXPECT_FLOAT_EQ((*parse_emotion_intensity("angry"))[6], 1);
  EXPECT_FALSE(parse_emotion_intensity("angry:"));
  EXPECT_FALSE(parse_style("S12"));
}

}  // namespace
}  // namespace mien
