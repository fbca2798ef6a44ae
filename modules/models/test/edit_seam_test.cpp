// Joins of edits with the model that ships, on recordings of people (docs/editing.md has the table).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "build_kind.h"
#include "mien/audio/load_audio.h"
#include "mien/core/arkit.h"
#include "mien/models/edit.h"
#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

enum Part { lips, upper, gaze, head, num_parts };
constexpr const char* kPartNames[] = {"lips, jaw, cheeks", "lids, brows", "gaze", "head"};

Part part_of(std::string_view channel) {
  if (channel.starts_with("head")) return head;
  if (channel.starts_with("eyeLook")) return gaze;
  return channel.starts_with("eye") || channel.starts_with("brow") ? upper : lips;
}

// Length of the second difference of a part's channels at frame n.
double acceleration(const Motion& motion, Part part, std::int64_t n) {
  double sum = 0;
  for (std::size_t c = 0; c < motion.channels.size(); ++c) {
    if (part_of(motion.channels[c]) != part) continue;
    const double a = static_cast<double>(motion.frame(n - 1)[c]) -
                     2 * static_cast<double>(motion.frame(n)[c]) +
                     static_cast<double>(motion.frame(n + 1)[c]);
    sum += a * a;
  }
  return std::sqrt(sum);
}

double percentile(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
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

  std::array<double, num_parts> own{};
  for (const Part part : {lips, upper, gaze, head}) {
    std::vector<double> all;
    for (std::int64_t n = 1; n + 1 < motion.num_frames(); ++n) all.push_back(acceleration(motion, part, n));
    own[part] = percentile(all, 0.95);
  }
  // Stretches of 0.3 to 1.2 s, all over the clip, two takes each. Of each join, the frames that the new
  // motion has a part in and the old one too.
  std::array<std::vector<double>, num_parts> ratios;
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
      for (const Part part : {lips, upper, gaze, head})
        for (const std::int64_t n : {first - 1, first, first + length - 1, first + length})
          ratios[part].push_back(acceleration(take, part, n) /
                                 std::max(own[part], acceleration(motion, part, n)));
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
  std::ptrdiff_t num_above = 0, num_joins = 0;
  for (const Part part : {lips, upper, gaze, head}) {
    const auto above =
        std::count_if(ratios[part].begin(), ratios[part].end(), [](double r) { return r > 1; });
    num_above += above;
    num_joins += std::ssize(ratios[part]);
    std::printf("%-28s %-18s p95 %.4f  at joins: median %.2f  p95 %.2f  largest %.2f  above 1: %ld of %zu\n",
                fs::path(GetParam()).filename().c_str(), kPartNames[part], own[part],
                percentile(ratios[part], 0.5), percentile(ratios[part], 0.95), percentile(ratios[part], 1),
                static_cast<long>(above), ratios[part].size());
  }
  // A join is as smooth as the clip when it lies below the clip's 95th percentile, or where the kept motion
  // itself is rougher, below that. Of the clip's own frames one in twenty lies above; of the joins no more
  // may.
  EXPECT_LE(static_cast<double>(num_above), 0.05 * static_cast<double>(num_joins));
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
