#include "mien/io/flame_csv.h"

#include <gmock/gmock.h>

#include <cmath>

#include "io_test_support.h"
#include "mien/base/file.h"
#include "mien/core/flame_parameters.h"
#include "mien/io/motion_file.h"
#include "mien/io/npy.h"

namespace mien {
namespace {

using testing::HasSubstr;

Motion parameters(std::int64_t num_frames) {
  Motion motion{MotionSpace::flame, flame_channels(0, 50), 25, {}};
  for (std::int64_t i = 0; i < 53 * num_frames; ++i)
    motion.values.push_back(std::sin(static_cast<float>(i)) / 3);
  return motion;
}

std::string text_of(const Motion& motion) {
  std::string text;
  const Status status = write_flame_csv(motion, [&](std::string_view piece) -> Status {
    text += piece;
    return Done{};
  });
  EXPECT_TRUE(status) << status.error().message();
  return text;
}

TEST(FlameCsv, ReadsBackTheSameFloats) {
  for (const std::int64_t num_frames : {0, 1, 2, 40}) {
    const Motion motion = parameters(num_frames);
    const std::string text = text_of(motion);
    EXPECT_TRUE(is_flame_csv(text));
    const auto back = read_flame_csv(text);
    ASSERT_TRUE(back) << back.error().message();
    EXPECT_EQ(back->space, MotionSpace::flame);
    EXPECT_EQ(back->channels, motion.channels);
    EXPECT_EQ(back->values, motion.values);
    EXPECT_EQ(back->fps, 25);
  }
  EXPECT_EQ(read_flame_csv(text_of(parameters(3)), 50)->fps, 50);
}

TEST(FlameCsv, RefusesWhatItCannotHold) {
  Motion arkit = parameters(1);
  arkit.space = MotionSpace::arkit;
  EXPECT_EQ(write_flame_csv(arkit, [](std::string_view) -> Status { return Done{}; }).error().code,
            Errc::incompatible);
  Motion broken = parameters(2);
  broken.values[60] = NAN;
  EXPECT_EQ(write_flame_csv(broken, [](std::string_view) -> Status { return Done{}; }).error().code,
            Errc::failed);
}

TEST(FlameCsv, NamesTheLineThatIsWrong) {
  const auto refusal = [](std::string_view text) {
    const auto motion = read_flame_csv(text);
    EXPECT_FALSE(motion) << text;
    return motion ? std::string() : motion.error().message();
  };
  EXPECT_THAT(refusal(""), HasSubstr("line 1"));
  EXPECT_THAT(refusal("time\n0\n"), HasSubstr("names no FLAME parameter"));
  EXPECT_THAT(refusal("time,jaw_x,jaw_x\n"), HasSubstr("twice"));
  EXPECT_THAT(refusal("time,jaw_x,smile\n"), HasSubstr("'smile'"));
  EXPECT_THAT(refusal("time,jaw_x\n0,1\n0.04\n"), HasSubstr("line 3"));
  EXPECT_THAT(refusal("time,jaw_x\n0,nan\n"), HasSubstr("'nan'"));
  EXPECT_THAT(refusal("time,jaw_x\n0,1e60\n"), HasSubstr("no number"));
  EXPECT_THAT(refusal("time,jaw_x\n0,1\n0.04,1\n0.2,1\n"), HasSubstr("even"));
  EXPECT_THAT(refusal("time,jaw_x\n0,1\n0,1\n"), HasSubstr("frame"));
  // Cut anywhere, a file is read or refused; it never reads beyond its end.
  const std::string whole = text_of(parameters(2));
  for (std::size_t n = 0; n < whole.size(); n += 7) {
    const std::string cut = whole.substr(0, n);
    (void)read_flame_csv(cut);
  }
}

TEST(FlameNpy, HasTheShapeOfTheAuthorsFiles) {
  const auto path = std::filesystem::path(testing::TempDir()) / "mien_flame.npy";
  const Motion motion = parameters(4);
  ASSERT_TRUE(write_motion(path, motion));
  const auto bytes = read_file(path);
  const auto layout = read_npy_layout(*bytes);
  ASSERT_TRUE(layout) << layout.error().message();
  EXPECT_THAT(layout->shape, testing::ElementsAre(1, 4, 403));
  EXPECT_EQ(layout->item_size, 8u);
  const auto back = read_motion(path);
  ASSERT_TRUE(back) << back.error().message();
  EXPECT_EQ(back->space, MotionSpace::flame);
  EXPECT_EQ(back->fps, 25);
  EXPECT_EQ(back->num_frames(), 4);
  for (std::int64_t n = 0; n < 4; ++n) {
    EXPECT_EQ(back->frame(n)[0], 0) << "no shape";
    EXPECT_EQ(back->frame(n)[310], motion.frame(n)[10]);
    EXPECT_EQ(back->frame(n)[402], motion.frame(n)[52]);
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace mien
