#include "mien/io/motion_json.h"

#include <cmath>
#include <limits>
#include <locale>

#include "io_test_support.h"

namespace mien {
namespace {

using namespace test;

Motion small_motion() {
  return {MotionSpace::arkit,
          {"jawOpen", "a \"quoted\" name"},
          30000.0 / 1001,
          {0, 1, 0.1f, -2.5e-9f, 1e20f, 0.3333333f}};
}

void expect_same_motion(const Motion& a, const Motion& b) {
  EXPECT_EQ(a.space, b.space);
  EXPECT_EQ(a.channels, b.channels);
  EXPECT_EQ(a.topology, b.topology);
  EXPECT_EQ(a.fps, b.fps);
  EXPECT_EQ(a.values, b.values);
}

TEST(MotionJson, RoundTripIsExact) {
  for (const auto space : {MotionSpace::arkit, MotionSpace::flame, MotionSpace::rig}) {
    Motion motion = small_motion();
    motion.space = space;
    const auto read = read_motion_json(*motion_json(motion, "voice.wav"));
    ASSERT_TRUE(read) << read.error().message();
    expect_same_motion(*read, motion);
  }
  Motion none = small_motion();
  none.values.clear();
  expect_same_motion(*read_motion_json(*motion_json(none)), none);
}

TEST(MotionJson, OfVerticesSaysTheirNumberInsteadOfNames) {
  const Motion motion = vertex_motion({"pair", 2}, 25, {0, 1, 2, 3, 4, 5.5f});
  const std::string text = *motion_json(motion);
  EXPECT_FALSE(Json::parse(text).contains("channels"));
  const auto read = read_motion_json(text);
  ASSERT_TRUE(read) << read.error().message();
  expect_same_motion(*read, motion);
  for (const char* topology : {"", ", \"topology\": {}", ", \"topology\": {\"vertices\": 0}",
                               ", \"topology\": {\"vertices\": 1000000000000}", ", \"topology\": 7"}) {
    const auto bad =
        read_motion_json(std::string("{\"mien_motion\": 1, \"space\": \"vertices\", \"fps\": 25") + topology +
                         ", \"frames\": []}");
    ASSERT_FALSE(bad) << topology;
    EXPECT_EQ(bad.error().code, Errc::input);
  }
}

TEST(MotionJson, IsPlainJsonWithTheDocumentedFields) {
  const Json json = Json::parse(*motion_json(small_motion(), "voice.wav"));
  EXPECT_EQ(json["mien_motion"], 1);
  EXPECT_EQ(json["space"], "arkit");
  EXPECT_EQ(json["audio"], "voice.wav");
  EXPECT_EQ(json["channels"][1], "a \"quoted\" name");
  EXPECT_EQ(json["frames"].size(), 3u);
  EXPECT_EQ(json["frames"][0], Json({0, 1}));
  EXPECT_FALSE(Json::parse(*motion_json(small_motion())).contains("audio"));
}

TEST(MotionJson, IndependentOfTheLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::string expected = *motion_json(small_motion());
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const auto text = motion_json(small_motion());
  const auto read = read_motion_json(expected);
  std::locale::global(before);
  EXPECT_EQ(*text, expected);
  expect_same_motion(*read, small_motion());
}

TEST(MotionJson, RefusesWrongContent) {
  const auto with = [](const char* key, const Json& value) {
    Json json = Json::parse(*motion_json(small_motion()));
    json[key] = value;
    return read_motion_json(json.dump());
  };
  EXPECT_EQ(with("mien_motion", 2).error().code, Errc::incompatible);
  EXPECT_EQ(with("mien_motion", "1").error().code, Errc::incompatible);
  EXPECT_EQ(with("space", "dance").error().code, Errc::input);
  for (const Json& fps : {Json(0), Json(-30), Json("60"), Json(1e9), Json(1e-9), Json()})
    EXPECT_EQ(with("fps", fps).error().code, Errc::input) << fps;
  for (const Json& channels :
       {Json::array(), Json({"a", "a"}), Json({"a", 1}), Json("ab"), Json({"a", "b", "c"})})
    EXPECT_EQ(with("channels", channels).error().code, Errc::input) << channels;
  for (const Json& frames : {Json(), Json(3), Json::array({1, 2}), Json::array({Json::array({1})}),
                             Json::array({Json::array({1, "x"})}), Json::array({Json::array({1, 1e300})})})
    EXPECT_EQ(with("frames", frames).error().code, Errc::input) << frames;
  EXPECT_EQ(read_motion_json("{}").error().code, Errc::incompatible);
  EXPECT_EQ(read_motion_json("[1, 2]").error().code, Errc::incompatible);
  EXPECT_EQ(read_motion_json(R"({"mien_motion":1,"fps":1e999})").error().code, Errc::input);
  EXPECT_EQ(read_motion_json(std::string(100000, '[')).error().code, Errc::input);
}

TEST(MotionJson, WriterRefusesNumbersThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::infinity(), std::nanf("")}) {
    Motion motion = small_motion();
    motion.values[3] = bad;
    const auto text = motion_json(motion);
    ASSERT_FALSE(text);
    EXPECT_NE(text.error().why.find("at frame 1"), std::string::npos);
  }
  Motion motion = small_motion();
  motion.fps = 0;
  EXPECT_FALSE(motion_json(motion));
}

TEST(MotionJson, ReadsAudio2FaceExports) {
  const Json json = {{"exportFps", 30.0},
                     {"trackPath", "voice.wav"},
                     {"numPoses", 3},
                     {"numFrames", 2},
                     {"facsNames", {"JawOpen", "tongueTipUp", "eyeBlinkLeft"}},
                     {"weightMat", {{0.5, 9, 0.25}, {1, 9, 0}}}};
  const auto read = read_motion_json(json.dump());
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->channels, (std::vector<std::string>{"eyeBlinkLeft", "jawOpen"}));
  EXPECT_EQ(read->values, (std::vector<float>{0.25f, 0.5f, 0, 1}));
  EXPECT_EQ(read->fps, 30);
  EXPECT_EQ(read.warnings.at(0), "poses without an ARKit name: tongueTipUp");
  Json other = json;
  other["facsNames"] = {"p1", "p2", "p3"};
  const auto rig = read_motion_json(other.dump());
  ASSERT_TRUE(rig);
  EXPECT_EQ(rig->space, MotionSpace::rig);
  EXPECT_EQ(rig->channels.size(), 3u);
  other["weightMat"][1] = {1, 2};
  EXPECT_EQ(read_motion_json(other.dump()).error().code, Errc::input);
  other.erase("exportFps");
  EXPECT_EQ(read_motion_json(other.dump()).error().code, Errc::input);
}

TEST(MotionJson, SurvivesTruncationAndFlippedBytes) {
  const std::string text = *motion_json(small_motion(), "voice.wav");
  const auto span = as_bytes(text);
  torture(
      Bytes(span.begin(), span.end()),
      [](const Bytes& b) { return read_motion_json(as_text(b)).has_value(); },
      [&](std::size_t n) { return n + 1 == text.size(); });  // only the last line's end may be missing
}

}  // namespace
}  // namespace mien
