#include "mien/models/edit.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "default/kept_face.h"
#include "mien/audio/load_audio.h"
#include "mien/base/random.h"
#include "mien/core/arkit.h"
#include "small_face_model.h"
#include "small_model.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Two seconds of a sound as a file, a small model, and a motion that it made.
class EditTest : public testing::Test {
 protected:
  EditTest() : path_(fs::temp_directory_path() / ("mien_edit_" + std::to_string(::getpid()) + ".wav")) {
    std::vector<std::int16_t> samples(32000);
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] = static_cast<std::int16_t>(6000 * std::sin(static_cast<double>(i) / 9) *
                                             std::max(0.0, std::sin(static_cast<double>(i) / 2500)));
    std::ofstream file(path_, std::ios::binary);
    const auto number = [&](std::uint32_t value, int bytes) {
      for (int b = 0; b < bytes; ++b) file.put(static_cast<char>(value >> (8 * b)));
    };
    const auto size = static_cast<std::uint32_t>(2 * samples.size());
    file << "RIFF", number(36 + size, 4), file << "WAVEfmt ", number(16, 4), number(1, 2), number(1, 2);
    number(16000, 4), number(32000, 4), number(2, 2), number(16, 2), file << "data", number(size, 4);
    file.write(reinterpret_cast<const char*>(samples.data()), size);
  }
  ~EditTest() override { fs::remove(path_); }

  Motion animated(std::uint64_t seed = 0) {
    PerformOptions options;
    options.seed = seed;
    return *animate(model_, *load_audio(path_), options, progress_);
  }
  Result<std::vector<Motion>> edited(const Motion& motion, const KeptValues& kept, int takes = 1,
                                     int threads = 1, std::uint64_t seed = 0) {
    auto reader = AudioReader::open(path_);
    PerformOptions options;
    options.seed = seed;
    return edit(model_, *reader, motion, kept, options, takes, threads, progress_);
  }

  fs::path path_;
  DefaultModel model_ = small_model();
  Progress progress_;
};

KeptValues outside(const Motion& motion, std::int64_t first, std::int64_t end) {
  KeptValues kept(motion);
  const FrameRange stretch{first, end};
  kept.keep_outside({&stretch, 1});
  return kept;
}

TEST_F(EditTest, MakesAStretchAnewAndKeepsTheRest) {
  const Motion motion = animated();
  const KeptValues kept = outside(motion, 40, 80);
  const auto takes = edited(motion, kept, 2);
  ASSERT_TRUE(takes) << takes.error().message();
  ASSERT_EQ(takes->size(), 2u);
  for (const Motion& take : *takes) {
    ASSERT_EQ(take.values.size(), motion.values.size());
    int differ = 0;
    for (std::int64_t n = 0; n < motion.num_frames(); ++n)
      for (std::size_t c = 0; c < 55; ++c) {
        if (n < 40 || n >= 80) {
          ASSERT_EQ(take.frame(n)[c], motion.frame(n)[c]) << n << " " << c;
        } else {
          differ += take.frame(n)[c] != motion.frame(n)[c];
        }
      }
    EXPECT_GT(differ, 400);
  }
  EXPECT_NE((*takes)[0].values, (*takes)[1].values);
}

TEST_F(EditTest, ThreadsDoNotMatterAndSeedsDo) {
  const Motion motion = animated();
  const KeptValues kept = outside(motion, 40, 80);
  const auto one = edited(motion, kept, 3, 1), three = edited(motion, kept, 3, 3),
             other = edited(motion, kept, 1, 1, 9);
  ASSERT_TRUE(one && three && other);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ((*one)[k].values, (*three)[k].values);
  EXPECT_NE((*one)[0].values, (*other)[0].values);
}

TEST_F(EditTest, HonoursChannelsAndKeys) {
  const Motion motion = animated();
  KeptValues kept(motion);
  const auto jaw = *motion.find("jawOpen"), brow = *motion.find("browInnerUp"), yaw = *motion.find("headYaw");
  kept.keep_channel(jaw);
  kept.set(70, brow, 0.8125f);
  kept.set(90, yaw, -11.3f);
  const auto takes = edited(motion, kept);
  ASSERT_TRUE(takes) << takes.error().message();
  const Motion& take = takes->front();
  for (std::int64_t n = 0; n < motion.num_frames(); ++n)
    ASSERT_EQ(take.frame(n)[static_cast<std::size_t>(jaw)], motion.frame(n)[static_cast<std::size_t>(jaw)]);
  EXPECT_EQ(take.frame(70)[static_cast<std::size_t>(brow)], 0.8125f);
  EXPECT_EQ(take.frame(90)[static_cast<std::size_t>(yaw)], -11.3f);
  EXPECT_NE(take.frame(60)[static_cast<std::size_t>(yaw)], motion.frame(60)[static_cast<std::size_t>(yaw)]);
}

TEST_F(EditTest, WhatIsKeptDecidesWhatIsMade) {
  const Motion motion = animated();
  const auto yaw = static_cast<std::size_t>(*motion.find("headYaw"));
  Motion turned = motion;  // another past of the head
  for (std::int64_t n = 0; n < 60; ++n) turned.frame(n)[yaw] += 9;
  const auto a = edited(motion, outside(motion, 60, 120)), b = edited(turned, outside(turned, 60, 120));
  ASSERT_TRUE(a && b);
  // Far beyond the fade of the join, the clean past still tells.
  bool differs = false;
  for (std::size_t c = 41; c < 52; ++c) differs |= a->front().frame(119)[c] != b->front().frame(119)[c];
  differs |= a->front().frame(119)[yaw] != b->front().frame(119)[yaw];
  EXPECT_TRUE(differs);
}

TEST_F(EditTest, OtherRatesAndChannelsAreTakenAsTheyAre) {
  Motion motion = resample(animated(), 30);
  motion.channels.push_back("leftEyeYaw");
  std::vector<float> wider;
  for (std::int64_t n = 0; n < 60; ++n)
    for (std::size_t c = 0; c < 56; ++c)
      wider.push_back(c < 55 ? motion.values[static_cast<std::size_t>(n) * 55 + c] : static_cast<float>(n));
  motion.values = wider;
  const auto takes = edited(motion, outside(motion, 20, 40));
  ASSERT_TRUE(takes) << takes.error().message();
  EXPECT_EQ(takes->front().fps, 30);
  for (std::int64_t n = 0; n < 60; ++n) EXPECT_EQ(takes->front().frame(n)[55], static_cast<float>(n));
  for (std::size_t i = 0; i < 20 * 56; ++i) ASSERT_EQ(takes->front().values[i], motion.values[i]);
  Motion lips{MotionSpace::arkit, {"mouthClose", "jawOpen"}, 60, std::vector<float>(240)};
  EXPECT_TRUE(edited(lips, outside(lips, 20, 40)));
}

TEST_F(EditTest, RefusesWhatDoesNotFit) {
  Motion motion = animated();
  Motion half = motion;
  half.values.resize(55 * 60);
  const auto wrong = edited(half, outside(half, 20, 40));
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, Errc::incompatible);
  EXPECT_THAT(wrong.error().message(), HasSubstr("1.00 s, the speech 2.00 s"));
  Motion rig{MotionSpace::rig, {"a"}, 60, std::vector<float>(120)};
  EXPECT_EQ(edited(rig, outside(rig, 20, 40)).error().code, Errc::incompatible);
  Motion none{MotionSpace::arkit, {"leftEyeYaw"}, 60, std::vector<float>(120)};
  EXPECT_EQ(edited(none, outside(none, 20, 40)).error().code, Errc::incompatible);
  EXPECT_THROW((void)edited(motion, KeptValues(half)), std::logic_error);
}

// FaceDiffuser on a mesh of 20 vertices, and on a rig with a scaler.
template <class Network>
FaceModel face_model(ModelFile description, Network network) {
  const auto path = fs::temp_directory_path() / ("mien_edit_" + std::to_string(::getpid()) + ".safetensors");
  write_face_model(path, description, std::move(network));
  auto model = FaceModel::load(path);
  EXPECT_TRUE(model) << model.error().message();
  fs::remove(path);
  return std::move(*model);
}

template <class Network>
void expect_edits_frames_and_channels(const ModelFile& description, Network network) {
  const FaceModel model = face_model(description, std::move(network));
  AudioClip speech;
  speech.samples.resize(24000);
  NoiseField(1, 1).normal(0, 0, speech.samples);
  Progress progress;
  const Motion motion = animate(model, speech, {}, 1, 1, progress)->front();
  const std::int64_t num_frames = motion.num_frames(), width = motion.num_channels();
  KeptValues kept(motion);
  const FrameRange stretch{10, 25};
  kept.keep_outside({&stretch, 1});
  for (std::int64_t c = 0; c < width / 2; ++c) kept.keep_channel(c);
  const auto takes = edit(model, speech, motion, kept, {}, 2, 1, progress);
  ASSERT_TRUE(takes) << takes.error().message();
  const auto threads = edit(model, speech, motion, kept, {}, 2, 3, progress);
  for (std::size_t k = 0; k < 2; ++k) {
    const Motion& take = (*takes)[k];
    EXPECT_EQ(take.values, (*threads)[k].values);
    int differ = 0;
    for (std::int64_t n = 0; n < num_frames; ++n)
      for (std::int64_t c = 0; c < width; ++c) {
        const auto at = static_cast<std::size_t>(c);
        if (kept.keeps(n, c)) {
          ASSERT_EQ(take.frame(n)[at], motion.frame(n)[at]) << n << " " << c;
        } else {
          differ += take.frame(n)[at] != motion.frame(n)[at];
        }
      }
    EXPECT_GT(differ, 15);
  }
  EXPECT_NE((*takes)[0].values, (*takes)[1].values);
  // What is kept decides what is made, and not by the fades alone: the same past and another one.
  Motion other = motion;
  for (float& v : other.values) v += 0.5f;
  KeptValues past(motion), other_past(other);
  const FrameRange rest{10, num_frames};
  past.keep_outside({&rest, 1});
  other_past.keep_outside({&rest, 1});
  const auto after = edit(model, speech, motion, past, {}, 1, 1, progress),
             after_other = edit(model, speech, other, other_past, {}, 1, 1, progress);
  int differ = 0;
  for (std::int64_t n = 10 + 6; n < num_frames; ++n)  // beyond the fade
    for (std::size_t c = 0; c < static_cast<std::size_t>(width); ++c)
      differ += after->front().frame(n)[c] != after_other->front().frame(n)[c];
  EXPECT_GT(differ, 0);
}

TEST(EditFace, KeepsFramesAndVerticesOfAMesh) {
  expect_edits_frames_and_channels(face_description(Architecture::facediffuser_v),
                                   facediffuser::VertexDenoiser<Tensor>(small_mesh_sizes()));
}

TEST(EditFace, KeepsFramesAndControlsOfARig) {
  ModelFile rig = face_description(Architecture::facediffuser_beat);
  rig.scaler = ModelScaler{std::vector<double>(7, 0.5), std::vector<double>(7, -0.25)};
  expect_edits_frames_and_channels(rig,
                                   facediffuser::BeatDenoiser<Tensor>({.variant = facediffuser::Variant::beat,
                                                                       .num_channels = 7,
                                                                       .latent = 6,
                                                                       .hidden = 6,
                                                                       .num_steps = 12,
                                                                       .condition = 32}));
}

TEST(KeptFace, SeesBlinksAndRaisesAsEvents) {
  Motion motion{MotionSpace::arkit, arkit_and_head_channels(), 60, std::vector<float>(240 * 55)};
  const BlinkEvent blink{.onset_s = 1.0, .closing_s = 0.08, .hold_s = 0.02, .opening_s = 0.19};
  for (std::int64_t n = 0; n < 240; ++n) {
    motion.frame(n)[arkit_index("eyeBlinkLeft")] = motion.frame(n)[arkit_index("eyeBlinkRight")] = 0.1f;
    motion.frame(n)[arkit_index("browInnerUp")] =
        0.2f + 0.3f * static_cast<float>(std::max(0.0, std::sin((static_cast<double>(n) - 150) / 8))) *
                   (n > 150 && n < 180 ? 1.0f : 0.0f);
  }
  apply_blinks(motion, {&blink, 1});
  const auto model = small_model();
  const KeptValues kept = outside(motion, 96, 120);
  const default_model::KeptFace face(kept, model.network().statistics);
  EXPECT_EQ(face.blink_class(48, 12), 0);
  const auto onset = face.blink_class(60, 12);
  ASSERT_TRUE(onset);
  EXPECT_NEAR(*onset, 2, 1) << "the blink begins at frame 60";
  EXPECT_EQ(face.blink_class(96, 12), std::nullopt);
  EXPECT_EQ(face.blink_class(84, 13), std::nullopt) << "its last frame is free";
  EXPECT_EQ(face.blink_class(240, 12), std::nullopt) << "beyond the motion nothing is known";
  EXPECT_GT(face.raise_class(148, 4).value_or(0) + face.raise_class(152, 4).value_or(0), 0);
  EXPECT_TRUE(face.may_blink(1.65, 1.9));
  EXPECT_FALSE(face.may_blink(1.65, 2.1));
  EXPECT_FALSE(face.may_blink(1.5, 1.7));
  // Without the blink, the numbers of its frames are those of the frames around it.
  const auto during = face.chunk(5), before = face.chunk(4);
  EXPECT_TRUE(during.is_known_entirely);
  for (std::size_t i = 0; i < 6 * 20; ++i)
    if (i % 20 < 14) {
      EXPECT_NEAR(during.samples[i], before.samples[i], 0.05) << i;
    }
  EXPECT_TRUE(face.chunk(8).is_free);
  EXPECT_TRUE(face.chunk(99).is_free);
}

TEST(KeptFace, ALidFollowsTheOtherWhereThatIsKept) {
  Motion motion{MotionSpace::arkit, arkit_and_head_channels(), 60, std::vector<float>(120 * 55)};
  const BlinkEvent blink{.onset_s = 1.0, .closing_s = 0.08, .hold_s = 0.02, .opening_s = 0.19};
  apply_blinks(motion, {&blink, 1});
  KeptValues kept(motion);
  kept.keep_channel(static_cast<std::int64_t>(arkit_index("eyeBlinkLeft")));
  const default_model::KeptFace face(kept, small_model().network().statistics);
  EXPECT_GT(face.closure(66, {}).right, 0.9f);
  EXPECT_EQ(face.closure(30, {}).right, 0);
  EXPECT_FALSE(face.may_blink(0.2, 0.4));
}

}  // namespace
}  // namespace mien
