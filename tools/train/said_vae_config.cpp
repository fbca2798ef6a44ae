#include "said_vae_config.h"

namespace mien::train {

Result<SaidVaeConfig> read_said_vae_config(TomlFile& file) {
  constexpr std::int64_t kLeastWindow = 16;  // the convolutions leave at least a frame of it
  SaidVaeConfig c;
  c.run.read(file);
  auto& o = c.options;
  o.seed = c.run.seed;
  read_corpus_fields(file, c.corpus);
  file.read("run", "deviation", c.deviation);
  file.read("model", "window", c.sizes.window, at_least(kLeastWindow));
  file.read("model", "latent", c.sizes.latent, at_least(1));
  file.read("training", "epochs", o.num_epochs, at_least(1));
  file.read("training", "batch", o.batch, at_least(2));  // batch norms need it
  file.read("training", "learning_rate", c.learning_rate, above_zero());
  file.read("training", "warm_up_share", c.warm_up_share, share_below_one());
  file.read("training", "average_decay", c.average_decay, share_below_one());
  file.read("training", "divide_by_deviation", c.divides);
  file.read("training", "velocity_weight", o.velocity_weight, not_negative());
  file.read("training", "cycles", o.num_cycles, at_least(1));
  file.read("training", "rising", o.rising, share());
  if (o.rising == 0) file.complain("[training] rising must be above 0");
  file.read("training", "highest_weight", o.highest_weight, not_negative());
  file.read("training", "checkpoint_every", c.checkpoint_every, at_least(1));
  file.read("training", "validate_every", c.validate_every, at_least(1));
  file.read("random", "mirror", o.mirror_probability, share());
  MIEN_TRY([[maybe_unused]] const auto good, file.finish("See configs/said_vae.toml"));
  return c;
}

}  // namespace mien::train
