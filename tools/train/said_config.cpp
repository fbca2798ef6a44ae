#include "said_config.h"

namespace mien::train {

Result<SaidConfig> read_said_config(TomlFile& file) {
  SaidConfig c;
  c.run.read(file);
  auto& o = c.options;
  o.seed = c.run.seed;
  std::string schedule(beta_schedule_name(o.schedule)), loss = "absolute";
  file.read("run", "encoder", c.encoder);
  file.read("run", "sound", c.sound);
  file.read("run", "deviation", c.deviation);
  file.read("model", "width", c.width);
  file.read("model", "projection", c.projection);
  file.read("model", "alignment_bias", c.has_alignment_bias);
  file.read("model", "diffusion_steps", o.diffusion_steps);
  file.read("model", "schedule", schedule);
  file.read("training", "epochs", c.num_epochs);
  file.read("training", "batch", o.batch);
  file.read("training", "shortest_window", o.shortest_window);
  file.read("training", "learning_rate", c.learning_rate);
  file.read("training", "warm_up_epochs", c.warm_up_epochs);
  file.read("training", "average_decay", c.average_decay);
  file.read("training", "loss", loss);
  file.read("training", "velocity_weight", o.velocity_weight);
  file.read("training", "frozen", c.frozen);
  file.read("training", "checkpoint_every", c.checkpoint_every);
  file.read("training", "validate_every", c.validate_every);
  file.read("training", "validation_passes", c.validation_passes);
  file.read("training", "export_every", c.export_every);
  file.read("random", "unconditional", o.unconditional_probability);
  file.read("random", "mirror", o.mirror_probability);
  file.read("random", "shift", o.shift_probability);
  file.read("random", "encoder_dropout", o.encoder_dropout);
  file.read("random", "layer_drop", o.layer_drop);
  file.read("random", "spec_augment", o.spec_augment);
  file.read("random", "dropout", o.dropout);

  const auto need = [&](bool holds, const char* what) {
    if (!holds) file.complain(what);
  };
  const auto is_share = [](double value) { return value >= 0 && value <= 1; };
  need(!c.encoder.empty(), "[run] needs encoder, a model file that mien import wrote");
  need(c.width >= said::Sizes::kHeadWidth && c.width % said::Sizes::kHeadWidth == 0,
       "[model] width must be a multiple of 32");
  need(c.projection >= 0, "[model] projection must not be negative");
  need(o.diffusion_steps >= 1, "[model] diffusion_steps must be at least 1");
  if (const auto known = parse_beta_schedule(schedule))
    o.schedule = *known;
  else
    file.complain("[model] schedule '" + schedule + "' is not cosine or linear");
  need(c.num_epochs >= 1, "[training] epochs must be at least 1");
  need(o.batch >= 1, "[training] batch must be at least 1");
  need(o.shortest_window >= 2, "[training] shortest_window must be at least 2 frames");
  need(c.learning_rate > 0, "[training] learning_rate must be above 0");
  need(c.warm_up_epochs >= 0, "[training] warm_up_epochs must not be negative");
  need(c.average_decay >= 0 && c.average_decay < 1, "[training] average_decay must lie in [0, 1)");
  need(loss == "absolute" || loss == "squared", "[training] loss is neither absolute nor squared");
  o.is_squared = loss == "squared";
  need(o.velocity_weight >= 0, "[training] velocity_weight must not be negative");
  need(c.checkpoint_every >= 1, "[training] checkpoint_every must be at least 1");
  need(c.validate_every >= 0 && c.validation_passes >= 0 && c.export_every >= 0,
       "[training] validate_every, validation_passes and export_every must not be negative");
  need(is_share(o.unconditional_probability) && is_share(o.mirror_probability) &&
           is_share(o.shift_probability),
       "[random] unconditional, mirror and shift must lie in [0, 1]");
  need(o.dropout >= 0 && o.dropout < 1, "[random] dropout must lie in [0, 1)");
  MIEN_TRY([[maybe_unused]] const auto good, file.finish("See configs/said.toml"));
  return c;
}

}  // namespace mien::train
