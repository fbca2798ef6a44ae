#include "probtalk3d_config.h"

#include "mien/core/flame_parameters.h"
#include "mien/train/face_network.h"

namespace mien::train {
namespace {

void read_weights(TomlFile& file, probtalk3d::LossWeights& weights) {
  file.read("training", "latent_weight", weights.latent, not_negative());
  file.read("training", "expression_weight", weights.expression, not_negative());
  file.read("training", "jaw_weight", weights.jaw, not_negative());
}

}  // namespace

Result<ProbTalk3DPriorConfig> read_probtalk3d_prior_config(TomlFile& file) {
  ProbTalk3DPriorConfig c;
  c.run.read(file);
  c.options.seed = c.run.seed;
  auto& s = c.sizes;
  auto& o = c.options.prior;
  read_corpus_fields(file, c.corpus);
  bool is_gaussian = false;
  const auto parse_latent = [](const std::string& word) -> std::optional<bool> {
    if (word != "codes" && word != "gaussian") return std::nullopt;
    return word == "gaussian";
  };
  file.read_word("model", "latent", is_gaussian, parse_latent, "codes or gaussian");
  file.read("model", "width", s.width, at_least(1));
  file.read("model", "inner", s.inner, at_least(1));
  file.read("model", "heads", s.heads, at_least(1));
  file.read("model", "blocks", s.prior_blocks, at_least(1));
  file.read("model", "codes", s.num_codes, at_least(1));
  file.read("model", "code_width", s.code_width, at_least(1));
  file.read(
      "model", "expressions", c.num_expression,
      {1, static_cast<double>(kNumFlameExpression), true, true, "must be 1 to 100, FLAME's expressions"});
  if (s.heads >= 1 && s.width % s.heads != 0) file.complain("[model] width must be a multiple of heads");
  if (!is_gaussian && s.code_width >= 1 && s.width % s.code_width != 0)
    file.complain("[model] width must be a multiple of code_width, so that every clip is whole codes");
  if (is_gaussian) {
    s.num_codes = s.code_width = 0;
    o.weights = probtalk3d::kGaussianPrior;
  }
  file.read("training", "epochs", c.num_epochs, at_least(1));
  file.read("training", "learning_rate", c.learning_rate, above_zero());
  file.read("training", "weight_decay", c.weight_decay, not_negative());
  read_weights(file, o.weights);
  file.read("training", "commitment", o.commitment, not_negative());
  read_stopping(file, c.stopping);
  file.read("training", "checkpoint_every", c.checkpoint_every, at_least(1));
  file.read("random", "dropout", o.dropout, share_below_one());
  MIEN_TRY([[maybe_unused]] const auto good, file.finish("See configs/probtalk3d_prior.toml"));
  return c;
}

Result<ProbTalk3DConfig> read_probtalk3d_config(TomlFile& file) {
  ProbTalk3DConfig c;
  c.frozen = published_frozen();
  c.run.read(file);
  auto& o = c.options;
  o.seed = c.run.seed;
  read_encoder_choice(file, c.encoder);
  file.read("run", "prior", c.prior);
  if (c.prior.empty())
    file.complain("[run] needs prior, a model file of stage 1 (system = \"probtalk3d_prior\")");
  file.read("run", "subjects", c.subjects);
  read_corpus_fields(file, c.corpus);
  file.read("model", "blocks", c.num_blocks, at_least(1));
  file.read("training", "epochs", c.num_epochs, at_least(1));
  file.read("training", "learning_rate", c.learning_rate, above_zero());
  read_weights(file, o.weights);
  file.read("training", "frozen", c.frozen);
  file.read("training", "cache_features", o.keeps_features);
  read_stopping(file, c.stopping);
  file.read("training", "checkpoint_every", c.checkpoint_every, at_least(1));
  file.read("random", "encoder_dropout", o.encoder.dropout);
  file.read("random", "layer_drop", o.encoder.layer_drop);
  file.read("random", "spec_augment", o.encoder.spec_augment);
  file.read("random", "dropout", o.dropout, share_below_one());
  file.read("random", "prior_dropout", o.prior_dropout, share_below_one());
  MIEN_TRY([[maybe_unused]] const auto good, file.finish("See configs/probtalk3d.toml"));
  return c;
}

}  // namespace mien::train
