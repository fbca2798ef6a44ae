// mien animate with SAiD: options, formats, what it refuses.
#include <gmock/gmock.h>

#include "mien/core/arkit.h"
#include "mien/io/motion_file.h"
#include "mien/models/said/network.h"
#include "program.h"
#include "small_face_model.h"

namespace mien {
namespace {

using testing::HasSubstr;

class AnimateSaidTest : public ProgramTest {
 protected:
  AnimateSaidTest() {
    ModelFile m;
    m.architecture = Architecture::said;
    m.name = "small";
    m.encoder = small_face_encoder();
    m.output = {.space = "arkit", .channels = 32, .fps = 60, .topology = ""};
    m.diffusion = ModelDiffusion{"cosine", 1000};
    write_face_model(
        in_folder("said.safetensors"), m,
        said::Network<Tensor>({.width = 32, .context = 16, .time = 64, .inner = 64, .speech = 16}));
  }
  /// Six steps, unless `more` says otherwise.
  [[nodiscard]] Outcome said(std::vector<std::string> more) const {
    if (std::find(more.begin(), more.end(), "--steps") == more.end())
      more.insert(more.end(), {"--steps", "6"});
    more.insert(more.begin(), {"animate", "speech.wav", "--model", "said.safetensors"});
    return mien(more);
  }
};

TEST_F(AnimateSaidTest, WritesCoefficientsInEveryFormat) {
  const auto run = said({"-o", "a.said.csv", "-o", "a.csv", "-o", "a.json", "-o", "a.npy", "-o", "a.glb"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto motion = read_motion(in_folder("a.said.csv"));
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_EQ(motion->channels, arkit_order(ArkitOrder::said));
  EXPECT_EQ(motion->num_frames(), 120);
  EXPECT_EQ(motion->fps, 60);
  const auto array = read_motion(in_folder("a.npy"));
  ASSERT_TRUE(array);
  EXPECT_EQ(array->values, motion->values) << "the text reads back as the same floats";
  for (const float v : motion->values) EXPECT_TRUE(v >= 0 && v <= 1);
  EXPECT_TRUE(read_motion(in_folder("a.glb")));
}

TEST_F(AnimateSaidTest, TheSeedDecidesAndThreadsDoNot) {
  ASSERT_EQ(said({"--seed", "3", "--threads", "1", "-o", "a.npy"}).exit_code, 0);
  ASSERT_EQ(said({"--seed", "3", "--threads", "3", "-o", "b.npy"}).exit_code, 0);
  ASSERT_EQ(said({"--seed", "3", "--takes", "2", "-o", "c.npy"}).exit_code, 0);
  EXPECT_EQ(bytes_of("a.npy"), bytes_of("b.npy"));
  EXPECT_EQ(bytes_of("a.npy"), bytes_of("c-1.npy")) << "a take does not depend on the others";
  EXPECT_NE(bytes_of("a.npy"), bytes_of("c-2.npy"));
}

TEST_F(AnimateSaidTest, StartsFromAMotion) {
  ASSERT_EQ(said({"-o", "a.said.csv"}).exit_code, 0);
  const auto kept = said({"--init", "a.said.csv", "--strength", "0", "-o", "b.said.csv"});
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_THAT(kept.err, HasSubstr("no step to walk"));
  EXPECT_EQ(bytes_of("a.said.csv"), bytes_of("b.said.csv"));
  ASSERT_EQ(said({"--init", "a.said.csv", "--strength", "0.5", "-o", "c.said.csv"}).exit_code, 0);
  EXPECT_NE(bytes_of("a.said.csv"), bytes_of("c.said.csv"));
}

TEST_F(AnimateSaidTest, AWindowAsLongAsTheClipChangesNothing) {
  ASSERT_EQ(said({"-o", "a.npy"}).exit_code, 0);
  ASSERT_EQ(said({"--window", "10", "-o", "b.npy"}).exit_code, 0);
  EXPECT_EQ(bytes_of("a.npy"), bytes_of("b.npy"));
  ASSERT_EQ(said({"--window", "0.8", "-o", "c.npy"}).exit_code, 0);
  const auto motion = read_motion(in_folder("c.npy"));
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->num_frames(), 120);
}

TEST_F(AnimateSaidTest, EditsAStretch) {
  ASSERT_EQ(said({"-o", "a.said.csv"}).exit_code, 0);
  const auto edit = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"edit", "a.said.csv", "--speech", "speech.wav", "--model", "said.safetensors",
                               "--steps", "6", "-o", "b.said.csv"});
    return mien(more);
  };
  const auto run = edit({"--range", "0.5-1.0", "--lock", "jawOpen"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto before = read_motion(in_folder("a.said.csv")), after = read_motion(in_folder("b.said.csv"));
  ASSERT_TRUE(before && after);
  ASSERT_EQ(after->num_frames(), before->num_frames());
  const auto jaw = static_cast<std::size_t>(*before->find("jawOpen"));
  std::int64_t num_changed = 0;
  for (std::int64_t n = 0; n < before->num_frames(); ++n)
    for (std::size_t c = 0; c < before->channels.size(); ++c) {
      const bool is_kept = n < 30 || n > 60 || c == jaw;
      if (is_kept) {
        ASSERT_EQ(after->frame(n)[c], before->frame(n)[c]) << n << ' ' << c;
      }
      num_changed += after->frame(n)[c] != before->frame(n)[c];
    }
  EXPECT_GT(num_changed, 100);
  EXPECT_EQ(edit({"--range", "0.5-1.0", "--window", "1"}).exit_code, 2);
  EXPECT_EQ(edit({"--range", "0.5-1.0", "--init", "a.said.csv"}).exit_code, 2);
  EXPECT_EQ(edit({"--range", "0.5-1.0", "--emotion", "happy"}).exit_code, 2);
}

TEST_F(AnimateSaidTest, KnowsItsOptions) {
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--sampler", "ddim", "--eta", "0.5", "--guidance", "3", "--guidance-rescale", "0.7"},
           {"--sampler", "ddpm"},
           {"--sampler", "dpm++", "--guidance", "0"},
           {"--precision", "int8"}}) {
    auto words = more;
    words.insert(words.end(), {"-o", "out.npy"});
    const auto run = said(words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
  EXPECT_THAT(said({"--guidance", "0.5", "-o", "a.npy"}).err, HasSubstr("no guidance"));
  EXPECT_THAT(said({"--steps", "600", "-o", "a.npy"}).err, HasSubstr("all 1000"));
}

TEST_F(AnimateSaidTest, RefusesWhatDoesNotFit) {
  const auto refusal = [&](const std::vector<std::string>& more) {
    const auto run = said(more);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    return run.err;
  };
  EXPECT_THAT(refusal({"--emotion", "happy"}), HasSubstr("--emotion"));
  EXPECT_THAT(refusal({"--skip", "3"}), HasSubstr("--skip"));
  EXPECT_THAT(refusal({"--strength", "0.5"}), HasSubstr("--init"));
  EXPECT_THAT(refusal({"--eta", "0.5", "--sampler", "ddpm"}), HasSubstr("ddim"));
  EXPECT_THAT(refusal({"--mesh", "face.obj"}), HasSubstr("--mesh"));
  EXPECT_EQ(said({"--init", "absent.csv"}).exit_code, 3);
  const auto other = animate({"--guidance", "2"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("SAiD"));
  write_wav("tiny.wav", std::vector<float>(200, 0.1f));
  const auto tiny = mien({"animate", "tiny.wav", "--model", "said.safetensors", "--steps", "2"});
  EXPECT_EQ(tiny.exit_code, 3) << tiny.err;
}

}  // namespace
}  // namespace mien
