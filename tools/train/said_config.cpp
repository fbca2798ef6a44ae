#include "said_config.h"

namespace mien::train {

Result<SaidConfig> read_said_config(TomlFile& file) {
  SaidConfig c;
  c.run.read(file);
  auto& o = c.options;
  o.seed = c.run.seed;
  read_encoder_choice(file, c.encoder);
  read_corpus_fields(file, c.corpus);
  file.read("run", "sound", c.sound);
  file.read("run", "deviation", c.deviation);
  file.read("model", "width", c.width);
  if (c.width < said::Sizes::kHeadWidth || c.width % said::Sizes::kHeadWidth != 0)
    file.complain("[model] width must be a multiple of 32");
  file.read("model", "projection", c.projection, not_negative());
  file.read("model", "alignment_bias", c.has_alignment_bias);
  read_diffusion(file, o.schedule, o.diffusion_steps);
  file.read("training", "epochs", c.num_epochs, at_least(1));
  file.read("training", "batch", o.batch, at_least(1));
  file.read("training", "shortest_window", o.shortest_window, at_least(2));
  file.read("training", "learning_rate", c.learning_rate, above_zero());
  file.read("training", "warm_up_epochs", c.warm_up_epochs, not_negative());
  file.read("training", "average_decay", c.average_decay, share_below_one());
  read_is_squared(file, o.is_squared, "absolute");
  file.read("training", "velocity_weight", o.velocity_weight, not_negative());
  file.read("training", "frozen", c.frozen);
  file.read("training", "checkpoint_every", c.checkpoint_every, at_least(1));
  file.read("training", "validate_every", c.validate_every, not_negative());
  file.read("training", "validation_passes", c.validation_passes, not_negative());
  file.read("training", "export_every", c.export_every, not_negative());
  file.read("random", "unconditional", o.unconditional_probability, share());
  file.read("random", "mirror", o.mirror_probability, share());
  file.read("random", "shift", o.shift_probability, share());
  file.read("random", "encoder_dropout", o.encoder_dropout);
  file.read("random", "layer_drop", o.layer_drop);
  file.read("random", "spec_augment", o.spec_augment);
  file.read("random", "dropout", o.dropout, share_below_one());
  MIEN_TRY([[maybe_unused]] const auto good, file.finish("See configs/said.toml"));
  return c;
}

}  // namespace mien::train
