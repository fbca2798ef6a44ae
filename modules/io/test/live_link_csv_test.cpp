#include "mien/io/live_link_csv.h"

#include <cmath>
#include <locale>

#include "io_test_support.h"
#include "mien/base/random.h"
#include "mien/core/arkit.h"

namespace mien {
namespace {

using namespace test;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = text.find('\n', at);
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',')
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

Motion random_motion(std::int64_t num_frames, double fps = 60) {
  Motion motion{MotionSpace::arkit, arkit_and_head_channels(), fps, {}};
  Rng rng(3);
  for (std::int64_t n = 0; n < num_frames; ++n)
    for (std::size_t c = 0; c < 55; ++c)
      motion.values.push_back(static_cast<float>(c < 52 ? rng.uniform() : rng.uniform(-30, 30)));
  return motion;
}

void expect_near(const Motion& read, const Motion& made) {
  EXPECT_EQ(read.channels, made.channels);
  EXPECT_EQ(read.fps, made.fps);
  ASSERT_EQ(read.values.size(), made.values.size());
  const std::size_t width = made.channels.size();
  for (std::size_t i = 0; i < made.values.size(); ++i)
    ASSERT_NEAR(read.values[i], made.values[i], i % width < 52 ? 1e-8 : 1e-5)
        << i / width << " " << i % width;
}

// Rows of two columns: a time and jawOpen.
std::string small_csv(const std::vector<std::string>& times,
                      const char* header = "Timecode,BlendShapeCount,JawOpen") {
  std::string text = std::string(header) + "\n";
  for (std::size_t i = 0; i < times.size(); ++i) text += times[i] + ",61," + std::to_string(i) + "\n";
  return text;
}

TEST(LiveLinkCsv, HasTheColumnsOfTheApp) {
  const auto text = live_link_csv(random_motion(1));
  ASSERT_TRUE(text);
  const auto header = fields_of(lines_of(*text)[0]);
  ASSERT_EQ(header.size(), 63u);
  EXPECT_EQ(header[0], "Timecode");
  EXPECT_EQ(header[1], "BlendShapeCount");
  EXPECT_EQ(header[2], "EyeBlinkLeft");
  // The app writes right before left for these two pairs.
  EXPECT_EQ(header[2 + 14], "JawForward");
  EXPECT_EQ(header[2 + 15], "JawRight");
  EXPECT_EQ(header[2 + 16], "JawLeft");
  EXPECT_EQ(header[2 + 21], "MouthRight");
  EXPECT_EQ(header[2 + 22], "MouthLeft");
  EXPECT_EQ(header[53], "TongueOut");
  const std::vector<std::string> rotations(header.begin() + 54, header.end());
  EXPECT_EQ(rotations,
            (std::vector<std::string>{"HeadYaw", "HeadPitch", "HeadRoll", "LeftEyeYaw", "LeftEyePitch",
                                      "LeftEyeRoll", "RightEyeYaw", "RightEyePitch", "RightEyeRoll"}));
}

TEST(LiveLinkCsv, WritesValuesUnderTheirNames) {
  Motion motion{
      MotionSpace::arkit, {"headYaw", "jawRight", "jawLeft", "cheekPuff"}, 60, {90, 0.25f, 1, -1e-12f}};
  const auto row = fields_of(lines_of(*live_link_csv(motion))[1]);
  ASSERT_EQ(row.size(), 63u);
  EXPECT_EQ(row[0], "00:00:00:00.000");
  EXPECT_EQ(row[1], "61");
  EXPECT_EQ(row[2], "0.00000000");
  EXPECT_EQ(row[2 + 15], "0.25000000");
  EXPECT_EQ(row[2 + 16], "1.00000000");
  EXPECT_EQ(row[2 + 46], "0.00000000");  // not "-0.00000000"
  EXPECT_EQ(row[54], "1.57079633");      // radians
}

TEST(LiveLinkCsv, TimecodesCountFramesOfTheMotion) {
  const auto timecode = [](double fps, std::size_t n) {
    const Motion motion{MotionSpace::arkit, {"jawOpen"}, fps, std::vector<float>(n + 1)};
    return fields_of(lines_of(*live_link_csv(motion))[n + 1])[0];
  };
  EXPECT_EQ(timecode(60, 59), "00:00:00:59.000");
  EXPECT_EQ(timecode(60, 60), "00:00:01:00.000");
  EXPECT_EQ(timecode(30, 29), "00:00:00:29.000");
  EXPECT_EQ(timecode(5, 5 * 3600), "01:00:00:00.000");
  EXPECT_EQ(timecode(60, 60 * 61), "00:01:01:00.000");
  // Every instant k / 29.97: second 1 begins 0.97 frames after frame 29.
  EXPECT_EQ(timecode(30000.0 / 1001, 30), "00:00:01:00.030");
  EXPECT_EQ(timecode(30000.0 / 1001, 29), "00:00:00:29.000");
}

TEST(LiveLinkCsv, RoundTripAtUsualRates) {
  for (const double fps : {24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 120.0}) {
    const Motion motion = random_motion(260, fps);
    const auto read = read_live_link_csv(*live_link_csv(motion));
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_TRUE(read.warnings.empty());
    expect_near(*read, motion);
  }
  const Motion ntsc = random_motion(200, 30000.0 / 1001);
  const auto read = read_live_link_csv(*live_link_csv(ntsc), {.fps = 30000.0 / 1001});
  ASSERT_TRUE(read);
  expect_near(*read, ntsc);
}

TEST(LiveLinkCsv, ShortClipsNeedTheRateOption) {
  const Motion motion = random_motion(10, 30);
  EXPECT_EQ(read_live_link_csv(*live_link_csv(motion))->fps, 60);
  expect_near(*read_live_link_csv(*live_link_csv(motion), {.fps = 30}), motion);
  // A take whose timecodes count to 59, asked for at 30: half of the frames, each at its time.
  const Motion fast = random_motion(121, 60);
  const auto half = read_live_link_csv(*live_link_csv(fast), {.fps = 30});
  ASSERT_TRUE(half) << half.error().message();
  EXPECT_EQ(half->fps, 30);
  ASSERT_EQ(half->num_frames(), 61);
  EXPECT_TRUE(half.warnings.empty());
  for (std::int64_t n = 0; n < 61; ++n) EXPECT_NEAR(half->frame(n)[0], fast.frame(2 * n)[0], 1e-6);
}

TEST(LiveLinkCsv, ZeroAndOneFrame) {
  const auto none = read_live_link_csv(*live_link_csv(random_motion(0)));
  ASSERT_TRUE(none) << none.error().message();
  EXPECT_EQ(none->num_frames(), 0);
  EXPECT_EQ(none->channels.size(), 52u);
  expect_near(*read_live_link_csv(*live_link_csv(random_motion(1))), random_motion(1));
}

TEST(LiveLinkCsv, IndependentOfTheLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const Motion motion = random_motion(61);
  const std::string expected = *live_link_csv(motion);
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const auto text = live_link_csv(motion);
  const auto read = read_live_link_csv(expected);
  std::locale::global(before);
  EXPECT_EQ(*text, expected);
  expect_near(*read, motion);
}

TEST(LiveLinkCsv, RefusesDecimalCommas) {
  const auto read = read_live_link_csv("Timecode,BlendShapeCount,JawOpen\n00:00:00:00.000,61,0,25\n");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().what, "CSV line 2");
  EXPECT_NE(read.error().message().find("4 fields, expected 3. Numbers need a dot"), std::string::npos);
}

TEST(LiveLinkCsv, ReadsByNameWhateverTheOrderCaseAndCount) {
  const auto read = read_live_link_csv(
      "\xef\xbb\xbftimecode, blendshapecount ,blendShapes.tongueOut,EYEBLINK_L,Mood\r\n"
      "00:00:00:00.000,51,0.5,0.25,1\r\n\r\n00:00:00:01.000,51,0.75,1,1,\r\n");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->channels, (std::vector<std::string>{"eyeBlinkLeft", "tongueOut"}));
  EXPECT_EQ(read->values, (std::vector<float>{0.25f, 0.5f, 1, 0.75f}));
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_EQ(read.warnings[0], "columns that are not used: Mood");
}

TEST(LiveLinkCsv, FillsDroppedFramesAndPassesMidnight) {
  const auto read = read_live_link_csv(small_csv(
      {"23:59:59:58.000", "23:59:59:59.000", "00:00:00:00.000", "00:00:00:02.000", "00:00:01:00.000"}));
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->fps, 60);
  ASSERT_EQ(read->num_frames(), 63);
  EXPECT_EQ(read->values[2], 2);
  EXPECT_FLOAT_EQ(read->values[3], 2.5f);
  EXPECT_EQ(read->values[4], 3);
  EXPECT_EQ(read->values[62], 4);
}

TEST(LiveLinkCsv, InterpolatesBetweenUnevenRows) {
  const auto read = read_live_link_csv(small_csv({"10:00:00:00.000", "10:00:00:00.500", "10:00:00:01.500"}));
  ASSERT_TRUE(read);
  ASSERT_EQ(read->num_frames(), 3);
  EXPECT_FLOAT_EQ(read->values[1], 1.5f);
  EXPECT_FLOAT_EQ(read->values[2], 2.0f);  // the last value holds
}

TEST(LiveLinkCsv, NumbersBetweenLargeOnesStayFinite) {
  const auto read = read_live_link_csv("timecode,jawOpen\n0,3e38\n0.5,-3e38\n0.6,0\n1,1\n");
  ASSERT_TRUE(read);
  for (const float v : read->values) EXPECT_TRUE(std::isfinite(v));
}

TEST(LiveLinkCsv, LeavesOutRowsThatGoBackAndRowsWithoutAFace) {
  const auto read = read_live_link_csv(
      "Timecode,BlendShapeCount,JawOpen\n00:00:00:00.000,61,1\n00:00:00:01.000,0,\n00:00:00:02.000,61,3\n"
      "00:00:00:01.000,61,9\n00:00:00:02.000,61,9\n00:00:00:03.000,61,4\n");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->values, (std::vector<float>{1, 2, 3, 4}));
  ASSERT_EQ(read.warnings.size(), 2u);
  EXPECT_EQ(read.warnings[0], "2 rows go back in time and are left out");
  EXPECT_EQ(read.warnings[1], "1 rows without a face are left out");
}

TEST(LiveLinkCsv, RotationsAreRadiansUnlessTheyAreTooLarge) {
  const auto radians =
      read_live_link_csv("Timecode,BlendShapeCount,JawOpen,HeadYaw\n00:00:00:00.000,61,0,1.0\n");
  EXPECT_NEAR(radians->values[1], 57.29578, 1e-4);
  const auto degrees = read_live_link_csv(
      "Timecode,BlendShapeCount,JawOpen,HeadYaw,LeftEyeYaw\n00:00:00:00.000,61,0,1.0,0\n00:00:00:01.000,61,0,"
      "-12,0\n");
  EXPECT_EQ(degrees->channels, (std::vector<std::string>{"jawOpen", "headYaw"}));
  EXPECT_EQ(degrees->values[1], 1);
  EXPECT_EQ(degrees->values[3], -12);
  // Eyes come along when they turn, and can be written again.
  const std::string eyes = "Timecode,BlendShapeCount,JawOpen,RightEyePitch\n00:00:00:00.000,61,0,0.5\n";
  const auto read = read_live_link_csv(eyes);
  EXPECT_EQ(read->channels, (std::vector<std::string>{"jawOpen", "rightEyePitch"}));
  EXPECT_NEAR(std::stod(fields_of(lines_of(*live_link_csv(*read))[1])[61]), 0.5, 1e-7);
}

TEST(LiveLinkCsv, ReadsFaceDiffusersClock) {
  // 30 rows a second, timecodes in sixtieths: HH:MM:SS: + microseconds / 1e6 * 60.
  std::vector<std::string> times;
  for (int n = 0; n < 45; ++n) {
    const int sixtieths = 2 * n % 60;
    times.push_back(std::string("00:00:0") + (n < 30 ? "0" : "1") + ":" + (sixtieths < 10 ? "0" : "") +
                    std::to_string(sixtieths) + ".000");
  }
  const auto read = read_live_link_csv(small_csv(times));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->fps, 30);
  ASSERT_EQ(read->num_frames(), 45);
  EXPECT_EQ(read->values[44], 44);
}

TEST(LiveLinkCsv, ReadsAudio2FaceAndBareNames) {
  // Time in seconds, an unnamed row index in front.
  std::string text = ",timeCode,blendShapes.JawOpen,blendShapes.EyeBlinkLeft\n";
  for (int n = 0; n < 40; ++n) text += std::to_string(n) + "," + std::to_string(n / 30.0) + ",0.5,0.25\n";
  const auto read = read_live_link_csv(text);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->fps, 30);
  EXPECT_EQ(read->num_frames(), 40);
  EXPECT_TRUE(read.warnings.empty());
  const auto bare = read_live_link_csv("jawForward,jawLeft\n0.0,1.0\n1e-05,0.12345679\n", {.fps = 25});
  ASSERT_TRUE(bare);
  EXPECT_EQ(bare->fps, 25);
  EXPECT_EQ(bare->values, (std::vector<float>{0, 1, 1e-5f, 0.12345679f}));
}

TEST(LiveLinkCsv, RefusesWhatIsNoMotion) {
  const auto code = [](std::string_view text) { return read_live_link_csv(text).error().code; };
  EXPECT_EQ(code(""), Errc::input);
  EXPECT_EQ(code("\n\n"), Errc::input);
  EXPECT_EQ(code("a,b,c\n1,2,3\n"), Errc::incompatible);
  const std::string head = "Timecode,BlendShapeCount,JawOpen\n";
  for (const char* row :
       {"00:00:00:00.000,61\n", "00:00:00:00.000,61,nan\n", "00:00:00:00.000,61,inf\n",
        "00:00:00:00.000,61,1e99\n", "00:00:00:00.000,61,\n", "00:00:00:00.000,61,0.5x\n", "00:00:00,61,0\n",
        "x,61,0\n", "-1:00:00:00.000,61,0\n", "00:00:00:00.000,61,0\n5,61,0\n"})
    EXPECT_EQ(code(head + row), Errc::input) << row;
  // Two rows that are hours apart would be a million frames.
  EXPECT_EQ(code(head + "00:00:00:00.000,61,0\n09:00:00:00.000,61,0\n"), Errc::input);
  EXPECT_EQ(code(",timeCode,JawOpen\n0,0,1\n1,1e300,1\n"), Errc::input);
}

TEST(LiveLinkCsv, WriterRefusesWhatItCannotHold) {
  Motion motion = random_motion(2);
  motion.values[60] = NAN;
  EXPECT_EQ(live_link_csv(motion).error().code, Errc::failed);
  motion = random_motion(1);
  motion.space = MotionSpace::flame;
  EXPECT_EQ(live_link_csv(motion).error().code, Errc::incompatible);
  motion = {MotionSpace::arkit, {"jawOpen", "wink"}, 60, {0, 0}};
  EXPECT_EQ(live_link_csv(motion).warnings.at(0), "channels that Live Link CSV has no column for: wink");
  // An error of the sink ends the writing.
  int calls = 0;
  const auto status = write_live_link_csv(random_motion(50), [&](std::string_view) -> Status {
    if (++calls == 3) return Error{Errc::failed, "disk", "full", ""};
    return Done{};
  });
  EXPECT_EQ(status.error().why, "full");
  EXPECT_EQ(calls, 3);
}

TEST(LiveLinkCsv, SurvivesTruncationAndFlippedBytes) {
  const std::string text = *live_link_csv(random_motion(3));
  const auto span = as_bytes(text);
  const std::size_t header = text.find('\n');
  // A prefix that ends with a number is a shorter recording; it is never a longer one, and a cut line is an
  // error or warned about.
  for (std::size_t n = 0; n < text.size(); ++n) {
    const Bytes cut(span.begin(), span.begin() + static_cast<std::ptrdiff_t>(n));
    const auto read = read_live_link_csv(as_text(cut));
    EXPECT_TRUE(!read || n > 20) << n;
    if (!read || n < header) continue;
    EXPECT_LE(read->num_frames(), 3);
    EXPECT_TRUE(text[n - 1] == '\n' || !read.warnings.empty()) << n;
  }
  torture(
      Bytes(span.begin(), span.end()),
      [](const Bytes& b) { return read_live_link_csv(as_text(b)).has_value(); },
      [](std::size_t n) { return n > 20; });
}

}  // namespace
}  // namespace mien
