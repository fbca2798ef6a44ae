#include "training_config.h"

#include <dlfcn.h>

namespace mien::train {
namespace {

void read_stage(TomlFile& file, const char* table, StageOptions& stage) {
  file.read(table, "steps", stage.num_steps, at_least(1));
  file.read(table, "learning_rate", stage.learning_rate, above_zero());
  file.read(table, "warm_up_steps", stage.warm_up_steps, at_least(0));
  file.read(table, "weight_decay", stage.weight_decay, not_negative());
  file.read(table, "clip_norm", stage.clip_norm, not_negative());
  file.read(table, "average_decay", stage.average_decay, share_below_one());
  file.read(table, "checkpoint_every", stage.checkpoint_every, at_least(1));
}

// LibTorch's matrix products go to the BLAS that is installed, which has threads of its own that LibTorch leaves
// alone. Those of OpenBLAS wait by spinning, so beside other work they cost more than they give.
void limit_blas_threads(int num_threads) {
  using SetThreads = void (*)(int);
  if (const auto set = reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads")))
    set(num_threads);
}

}  // namespace

void RunConfig::read(TomlFile& file) {
  file.read("run", "system", system);
  file.read("run", "name", name);
  file.read("run", "data", data);
  file.read("run", "output", output);
  file.read("run", "work_folder", work_folder);
  file.read("run", "seed", seed);
  file.read("run", "threads", num_threads, at_least(1));
  if (data.empty() || output.empty() || work_folder.empty())
    file.complain("[run] needs data, output and work_folder");
  text = file.text();
}

Status RunConfig::begin() const {
  torch::set_num_threads(num_threads);
  limit_blas_threads(num_threads);
  std::error_code ec;
  std::filesystem::create_directories(work_folder, ec);
  if (ec) return Error{Errc::failed, work_folder.string(), "cannot be created: " + ec.message(), ""};
  return Done{};
}

Result<TrainingConfig> read_training_config(TomlFile& file) {
  TrainingConfig config;
  config.run.read(file);
  auto& o = config.options;
  o.seed = config.run.seed;
  file.read("model", "width", config.sizes.width, at_least(1));
  file.read("model", "condition", config.sizes.condition, at_least(1));
  file.read("model", "diffusion_hidden", config.sizes.diffusion_hidden, at_least(1));
  file.read("model", "blink_hidden", config.sizes.blink_hidden, at_least(1));
  file.read("model", "brow_hidden", config.sizes.brow_hidden, at_least(1));
  file.read("model", "look_ahead_mel_frames", o.look_ahead_mel_frames, at_least(0));
  read_stage(file, "mean", config.mean);
  file.read("mean", "batch", o.mean_batch, at_least(1));
  file.read("mean", "crop_frames", o.crop_frames, at_least(3));
  file.read("mean", "level_offset_sd_db", o.level_offset_sd_db, not_negative());
  file.read("mean", "difference_weight", o.difference_weight, not_negative());
  file.read("mean", "aperture_weight", o.aperture_weight, not_negative());
  file.read("mean", "upper_weight", o.upper_weight, not_negative());
  file.read("mean", "viseme_weight", o.viseme_weight, not_negative());
  file.read("mean", "event_weight", o.event_weight, not_negative());
  file.read("mean", "unknown_probability", o.unknown_probability, share());
  read_stage(file, "diffusion", config.diffusion);
  file.read("diffusion", "batch", o.sequence_batch, at_least(1));
  file.read("diffusion", "sequence_chunks", o.sequence_chunks, at_least(1));
  file.read("diffusion", "times_per_chunk", o.times_per_chunk, at_least(1));
  file.read("diffusion", "history_noise", o.history_noise, not_negative());
  file.read("diffusion", "max_snr_weight", o.max_snr_weight, above_zero());
  read_stage(file, "blink", config.blink);
  read_stage(file, "brow", config.brow);
  if (o.crop_frames % 3 != 0) file.complain("[mean] crop_frames must be a multiple of 3");
  MIEN_TRY([[maybe_unused]] const auto good, file.finish("See configs/default.toml"));
  return config;
}

}  // namespace mien::train
