#include "mien/core/motion_resampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "mien/core/motion.h"

namespace mien {
namespace {

Motion wave(std::int64_t num_frames) {
  Motion m{MotionSpace::rig, {"a", "b"}, 30, {}};
  for (std::int64_t n = 0; n < num_frames; ++n)
    for (const double phase : {0.0, 1.0})
      m.values.push_back(static_cast<float>(std::sin(0.3 * static_cast<double>(n) + phase)));
  return m;
}

TEST(MotionResampler, GivesTheSameForAnyCut) {
  for (const double fps : {1.0, 3.0, 24.0, 29.97, 30.0, 60.0, 100.0})
    for (const std::int64_t num_frames : {0, 1, 2, 14, 16, 61})
      for (const std::size_t piece : {1u, 2u, 7u, 1000u}) {
        const Motion in = wave(num_frames);
        const std::vector<float> whole = fps == in.fps ? in.values : resample(in, fps).values;
        MotionResampler resampler(in.fps, fps, 2);
        std::vector<float> out;
        for (std::size_t at = 0; at < in.values.size(); at += 2 * piece)
          resampler.push(std::span(in.values).subspan(at, std::min(2 * piece, in.values.size() - at)), out);
        resampler.finish(out);
        ASSERT_EQ(out, whole) << fps << " fps, " << num_frames << " frames, " << piece << " at a time";
      }
}

TEST(MotionResampler, HandsOutWhatIsCertain) {
  MotionResampler resampler(30, 60, 1);
  std::vector<float> out;
  resampler.push(std::vector<float>{0, 1, 2}, out);
  EXPECT_EQ(out, (std::vector<float>{0, 0.5, 1, 1.5}));
  resampler.finish(out);
  EXPECT_EQ(out, (std::vector<float>{0, 0.5, 1, 1.5, 2, 2}));
  EXPECT_THROW(resampler.push({}, out), std::logic_error) << "the motion is over";
  EXPECT_THROW(MotionResampler(30, 0, 1), std::logic_error);
}

}  // namespace
}  // namespace mien
