// mien-train on a configuration of the default model whose numbers cannot be.
#include <gtest/gtest.h>

#include "mien/base/file.h"
#include "running_program.h"
#include "test_folder.h"
#include "test_paths.h"

namespace mien {
namespace {

class DefaultConfig : public testing::Test {
 protected:
  // What mien-train says of a configuration with these lines; the data are absent.
  [[nodiscard]] std::string said_of(const std::string& run, const std::string& tables, int code) const {
    const std::string text =
        "[run]\nname = \"small\"\ndata = \"set.safetensors\"\noutput = \"model.safetensors\"\nwork_folder = "
        "\"work\"\n" +
        run + tables;
    EXPECT_TRUE(write_file(folder_.path() / "config.toml", std::string_view(text)));
    RunningProgram program(built_path("bin/mien-train").string(), {"config.toml", "--quiet"}, folder_.path());
    EXPECT_EQ(program.wait(), code) << tables << program.err();
    return program.err();
  }
  TestFolder folder_;
};

TEST_F(DefaultConfig, NumbersOutsideOfTheirRangeAreNamed) {
  const std::string all = said_of(
      "threads = 0\n",
      "[model]\nwidth = 0\ncondition = -1\ndiffusion_hidden = 0\nblink_hidden = 0\nbrow_hidden = 0\n"
      "look_ahead_mel_frames = -1\n"
      "[mean]\nsteps = 0\nbatch = 0\ncrop_frames = 0\nlearning_rate = 0.0\nwarm_up_steps = -1\n"
      "weight_decay = -1.0\nclip_norm = -1.0\naverage_decay = 1.0\ncheckpoint_every = 0\n"
      "level_offset_sd_db = -1.0\ndifference_weight = -1.0\naperture_weight = -1.0\nupper_weight = -1.0\n"
      "viseme_weight = -1.0\nevent_weight = -1.0\nunknown_probability = 1.5\n"
      "[diffusion]\nsteps = 0\nbatch = 0\nsequence_chunks = 0\ntimes_per_chunk = 0\nhistory_noise = -1.0\n"
      "max_snr_weight = 0.0\n"
      "[blink]\nlearning_rate = nan\n[brow]\ncheckpoint_every = -5\n",
      2);
  for (const char* field : {"[run] threads",
                            "[model] width",
                            "[model] condition",
                            "[model] diffusion_hidden",
                            "[model] blink_hidden",
                            "[model] brow_hidden",
                            "[model] look_ahead_mel_frames",
                            "[mean] steps",
                            "[mean] batch",
                            "[mean] crop_frames",
                            "[mean] learning_rate",
                            "[mean] warm_up_steps",
                            "[mean] weight_decay",
                            "[mean] clip_norm",
                            "[mean] average_decay",
                            "[mean] checkpoint_every",
                            "[mean] level_offset_sd_db",
                            "[mean] difference_weight",
                            "[mean] aperture_weight",
                            "[mean] upper_weight",
                            "[mean] viseme_weight",
                            "[mean] event_weight",
                            "[mean] unknown_probability",
                            "[diffusion] steps",
                            "[diffusion] batch",
                            "[diffusion] sequence_chunks",
                            "[diffusion] times_per_chunk",
                            "[diffusion] history_noise",
                            "[diffusion] max_snr_weight",
                            "[blink] learning_rate",
                            "[brow] checkpoint_every"})
    EXPECT_NE(all.find(field), std::string::npos) << field << "\n" << all;
}

TEST_F(DefaultConfig, NumbersWithinThemAreTaken) {
  const std::string said = said_of(
      "threads = 1\n",
      "[model]\nlook_ahead_mel_frames = 0\n[mean]\nwarm_up_steps = 0\nclip_norm = 0.0\naverage_decay = 0.0\n"
      "weight_decay = 0.0\nunknown_probability = 1.0\nlevel_offset_sd_db = 0.0\n",
      3);
  EXPECT_NE(said.find("set.safetensors"), std::string::npos) << "what is absent is the data: " << said;
}

}  // namespace
}  // namespace mien
