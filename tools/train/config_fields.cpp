#include "config_fields.h"

#include <algorithm>

namespace mien::train {

void read_encoder_choice(TomlFile& file, EncoderChoice& choice) {
  file.read("run", "encoder", choice.file);
  const bool is_new = file.has_table("encoder");
  if (is_new == !choice.file.empty()) {
    file.complain(is_new ? "there is [run] encoder and a table [encoder]: one of them is wanted"
                         : "[run] needs encoder, a model file that mien import wrote, or there is a table "
                           "[encoder] with the sizes of a new one");
    return;
  }
  if (!is_new) return;
  EncoderConfig config;
  std::int64_t convolutions = config.conv_dim.front();
  file.read("encoder", "width", config.hidden_size, at_least(1));
  file.read("encoder", "layers", config.num_hidden_layers, at_least(1));
  file.read("encoder", "heads", config.num_attention_heads, at_least(1));
  file.read("encoder", "inner", config.intermediate_size, at_least(1));
  file.read("encoder", "convolutions", convolutions, at_least(1));
  std::ranges::fill(config.conv_dim, convolutions);
  if (const Status valid = config.validate(); !valid) file.complain("[encoder] " + valid.error().message());
  choice.fresh = config;
}

void read_corpus_fields(TomlFile& file, CorpusFields& corpus) {
  file.read("run", "validation", corpus.validation);
  file.read("run", "takes", corpus.num_takes, at_least(1));
}

void read_diffusion(TomlFile& file, BetaSchedule& schedule, std::int64_t& num_steps) {
  file.read("model", "diffusion_steps", num_steps, at_least(1));
  file.read_word("model", "schedule", schedule, parse_beta_schedule, "cosine or linear");
  if (num_steps >= 1 &&
      std::ranges::any_of(betas_of(schedule, num_steps), [](double beta) { return beta >= 1; }))
    file.complain("[model] diffusion_steps are too few for the schedule: a beta is not below 1");
}

void read_is_squared(TomlFile& file, bool& is_squared, const std::string& other) {
  const auto parse = [&](const std::string& word) -> std::optional<bool> {
    if (word != "squared" && word != other) return std::nullopt;
    return word == "squared";
  };
  file.read_word("training", "loss", is_squared, parse, other + " or squared");
}

}  // namespace mien::train
