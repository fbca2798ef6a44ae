#include "said_vae_config.h"

namespace mien::train {

Result<SaidVaeConfig> read_said_vae_config(TomlFile& file) {
  SaidVaeConfig c;
  c.run.read(file);
  auto& o = c.options;
  o.seed = c.run.seed;
  file.read("run", "deviation", c.deviation);
  file.read("model", "window", c.sizes.window);
  file.read("model", "latent", c.sizes.latent);
  file.read("training", "epochs", o.num_epochs);
  file.read("training", "batch", o.batch);
  file.read("training", "learning_rate", c.learning_rate);
  file.read("training", "warm_up_share", c.warm_up_share);
  file.read("training", "average_decay", c.average_decay);
  file.read("training", "divide_by_deviation", c.divides);
  file.read("training", "velocity_weight", o.velocity_weight);
  file.read("training", "cycles", o.num_cycles);
  file.read("training", "rising", o.rising);
  file.read("training", "highest_weight", o.highest_weight);
  file.read("training", "checkpoint_every", c.checkpoint_every);
  file.read("training", "validate_every", c.validate_every);
  file.read("random", "mirror", o.mirror_probability);

  const auto need = [&](bool holds, const char* what) {
    if (!holds) file.complain(what);
  };
  constexpr std::int64_t kLeastWindow = 16;  // the convolutions leave at least a frame of it
  need(c.sizes.window >= kLeastWindow, "[model] window must be at least 16 frames");
  need(c.sizes.latent >= 1, "[model] latent must be at least 1");
  need(o.num_epochs >= 1, "[training] epochs must be at least 1");
  need(o.batch >= 2, "[training] batch must be at least 2: batch norms need it");
  need(c.learning_rate > 0, "[training] learning_rate must be above 0");
  need(c.warm_up_share >= 0 && c.warm_up_share < 1, "[training] warm_up_share must lie in [0, 1)");
  need(c.average_decay >= 0 && c.average_decay < 1, "[training] average_decay must lie in [0, 1)");
  need(o.num_cycles >= 1, "[training] cycles must be at least 1");
  need(o.rising > 0 && o.rising <= 1, "[training] rising must lie in (0, 1]");
  need(o.highest_weight >= 0 && o.velocity_weight >= 0, "[training] weights must not be negative");
  need(c.checkpoint_every >= 1, "[training] checkpoint_every must be at least 1");
  need(c.validate_every >= 1, "[training] validate_every must be at least 1");
  need(o.mirror_probability >= 0 && o.mirror_probability <= 1, "[random] mirror must lie in [0, 1]");
  MIEN_TRY([[maybe_unused]] const auto good, file.finish("See configs/said_vae.toml"));
  return c;
}

}  // namespace mien::train
