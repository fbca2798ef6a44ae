// Joins of edits with the model that ships, on recordings of people (docs/editing.md has the table).
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "build_kind.h"
#include "mien/audio/load_audio.h"
#include "mien/core/arkit.h"
#include "mien/models/edit.h"
#include "seam_measure.h"
#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

enum Part { lips, upper, gaze, head };
constexpr const char* kPartNames[] = {"lips, jaw, cheeks", "lids, brows", "gaze", "head"};

Part part_of(std::string_view channel) {
  if (channel.starts_with("head")) return head;
  if (channel.starts_with("eyeLook")) return gaze;
  return channel.starts_with("eye") || channel.starts_with("brow") ? upper : lips;
}

class EditSeams : public testing::TestWithParam<const char*> {
 protected:
  // An example of the repository, or a recording beside it.
  static fs::path recording() {
    const fs::path own = project_path(GetParam());
    return fs::exists(own) ? own : shared_path(GetParam());
  }
};

TEST_P(EditSeams, AreAsSmoothAsTheClip) {
  if (has_address_sanitizer())
    GTEST_SKIP() << "a measure, which takes minutes under a sanitizer; the tests of edit() run the same code";
  const fs::path model_path = project_path("share/default.safetensors");
  if (!fs::exists(model_path)) GTEST_SKIP() << "share/default.safetensors is absent";
  if (!fs::exists(recording())) GTEST_SKIP() << GetParam() << " is absent";
  const auto model = DefaultModel::load(model_path);
  ASSERT_TRUE(model) << model.error().message();
  Progress progress;
  const auto speech = load_audio(recording());
  ASSERT_TRUE(speech) << speech.error().message();
  const auto animated = animate(*model, *speech, {}, progress);
  ASSERT_TRUE(animated) << animated.error().message();
  const Motion& motion = *animated;

  std::vector<SeamMeasure> parts;
  for (const Part part : {lips, upper, gaze, head}) {
    std::vector<std::size_t> channels;
    for (std::size_t c = 0; c < motion.channels.size(); ++c)
      if (part_of(motion.channels[c]) == part) channels.push_back(c);
    parts.emplace_back(motion, std::move(channels));
  }
  // Stretches of 0.3 to 1.2 s, all over the clip, two takes each.
  int closed = 0, opened = 0;
  for (std::int64_t k = 0; k < 12; ++k) {
    const std::int64_t length = std::min<std::int64_t>(18 + 5 * k, motion.num_frames() / 3);
    const std::int64_t first = 10 + k * (motion.num_frames() - length - 20) / 12;
    KeptValues kept(motion);
    const FrameRange stretch{first, first + length};
    kept.keep_outside({&stretch, 1});
    PerformOptions options;
    options.seed = static_cast<std::uint64_t>(k);
    auto again = AudioReader::open(recording());
    const auto takes = edit(*model, *again, motion, kept, options, 2, 1, progress);
    ASSERT_TRUE(takes) << takes.error().message();
    for (const Motion& take : *takes) {
      for (SeamMeasure& part : parts) part.add(take, stretch);
      // The old motion's closures are where the speech has them: the new lips close there too.
      const auto jaw = static_cast<std::size_t>(*motion.find("jawOpen")),
                 close = static_cast<std::size_t>(*motion.find("mouthClose"));
      for (std::int64_t n = first + 4; n < first + length - 4; ++n) {
        if (motion.frame(n)[jaw] - motion.frame(n)[close] > 0 || motion.frame(n)[jaw] < 0.02f) continue;
        ++closed;
        opened += take.frame(n)[jaw] - take.frame(n)[close] > 0.04f;
      }
    }
  }
  std::ptrdiff_t num_above = 0, above_behind = 0, num_behind = 0;
  for (const Part part : {lips, upper, gaze, head}) {
    const SeamMeasure& m = parts[part];
    num_above += m.num_above();
    if (part != gaze) above_behind += m.num_above_behind(), num_behind += m.size_behind();
    std::printf("%-28s %-18s p95 %.4f  at joins: median %.2f  p95 %.2f  largest %.2f  above 1: %ld of %ld\n",
                fs::path(GetParam()).filename().c_str(), kPartNames[part], m.usual(), m.ratio(0.5),
                m.ratio(0.95), m.ratio(1), static_cast<long>(m.num_above()), static_cast<long>(m.size()));
  }
  // A join is as smooth as the clip when it lies below the clip's 95th percentile, or where the kept motion
  // itself is rougher, below that.
  EXPECT_EQ(num_above, 0);
  // Behind them it is as rough as the clip, of which one frame in twenty lies above. Eyes leap.
  EXPECT_LE(static_cast<double>(above_behind), 0.05 * static_cast<double>(num_behind));
  std::printf("%-28s behind the joins, without gaze: above 1: %ld of %ld\n",
              fs::path(GetParam()).filename().c_str(), static_cast<long>(above_behind),
              static_cast<long>(num_behind));
  std::printf("%-28s closed frames inside the stretches: %d, of which opened %d\n",
              fs::path(GetParam()).filename().c_str(), closed, opened);
  EXPECT_EQ(opened, 0);
}

INSTANTIATE_TEST_SUITE_P(Recordings, EditSeams,
                         testing::Values("examples/lj_LJ002-0020.wav",
                                         "audio/real/common_voice_en_651325.mp3",
                                         "audio/real/librispeech_2412-153948-0000.flac",
                                         "audio/real/a2f3d_Mark_joy.wav", "audio/human/arctic_a0024.flac"),
                         [](const auto& clip) { return "Clip" + std::to_string(clip.index); });

}  // namespace
}  // namespace mien
