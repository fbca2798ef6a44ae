#include "face_config.h"

#include <algorithm>

namespace mien::train {
namespace {

// Specifications of FaceDiffuser (sections 1, 6, 11, 14) and FaceXHuBERT (sections 1 and 5).
FaceConfig published(Architecture architecture) {
  FaceConfig c;
  c.architecture = architecture;
  c.frozen = published_frozen();
  switch (architecture) {
    case Architecture::facediffuser_beat:
      c.latent = c.hidden = 256;
      c.options.diffusion_steps = 1000;
      c.num_epochs = 101;
      break;
    case Architecture::facediffuser_damm:
      c.latent = c.hidden = 1024;
      c.decoder.num_layers = 4;
      c.options.diffusion_steps = 1000;
      c.num_epochs = 101;
      break;
    case Architecture::facexhubert:
      c.hidden = 256;
      c.num_epochs = 101;
      break;
    default:  // V has the values of BIWI
      break;
  }
  return c;
}

void check(const FaceConfig& c, TomlFile& file) {
  const auto positive = [&](std::int64_t value, const char* name) {
    if (value < 1) file.complain(std::string(name) + " must be at least 1");
  };
  const auto share = [&](double value, const char* name) {
    if (!(value >= 0 && value < 1)) file.complain(std::string(name) + " must lie in [0, 1)");
  };
  positive(c.latent, "[model] latent");
  positive(c.hidden, "[model] hidden");
  positive(c.decoder.num_layers, "[model] layers");
  positive(c.decoder.heads, "[model] heads");
  positive(c.options.diffusion_steps, "[model] diffusion_steps");
  positive(c.num_epochs, "[training] epochs");
  positive(c.checkpoint_every, "[training] checkpoint_every");
  share(c.options.decoder_dropout, "[random] decoder_dropout");
  share(c.options.mask_share, "[random] mask_share");
  if (!(c.learning_rate > 0)) file.complain("[training] learning_rate must be above 0");
  if (c.encoder.empty()) file.complain("[run] needs encoder, a model file that mien import wrote");
  if (c.options.diffusion_steps >= 1 &&
      std::ranges::any_of(betas_of(c.options.schedule, c.options.diffusion_steps),
                          [](double beta) { return beta >= 1; }))
    file.complain("[model] diffusion_steps are too few for the schedule: a beta is not below 1");
  if (c.decoder.kind == DecoderKind::transformer && c.decoder.heads >= 1 && c.hidden % c.decoder.heads != 0)
    file.complain("[model] hidden must be a multiple of heads");
  if (c.options.teacher_forcing && c.decoder.kind != DecoderKind::transformer)
    file.complain("[training] teacher_forcing is for the decoder 'transformer'");
  const bool is_tied =
      c.architecture == Architecture::facediffuser_v || c.architecture == Architecture::facediffuser_damm;
  if (is_tied && c.latent != c.hidden)
    file.complain("[model] latent and hidden must be equal in this system");
}

}  // namespace

Result<FaceConfig> read_face_config(TomlFile& file, Architecture architecture) {
  FaceConfig c = published(architecture);
  c.run.read(file);
  auto& o = c.options;
  o.seed = c.run.seed;
  file.read("run", "layout", c.layout);
  file.read("run", "encoder", c.encoder);
  file.read("run", "subjects", c.subjects);

  std::string decoder(decoder_kind_name(c.decoder.kind)),
      noise_encoder(facediffuser::noise_encoder_name(c.noise_encoder));
  file.read("model", "decoder", decoder);
  if (const auto known = parse_decoder_kind(decoder))
    c.decoder.kind = *known;
  else
    file.complain("[model] decoder '" + decoder + "' is not gru, rnn, lstm or transformer");
  if (c.decoder.kind == DecoderKind::transformer) {  // of the thesis' vanilla transformer, and PyTorch's own
    c.decoder.num_layers = 1;
    o.decoder_dropout = 0.1;
  }
  file.read("model", "hidden", c.hidden);
  file.read("model", "layers", c.decoder.num_layers);
  file.read("model", "heads", c.decoder.heads);
  if (architecture == Architecture::facediffuser_v) file.read("model", "noise_encoder", noise_encoder);
  if (const auto known = facediffuser::parse_noise_encoder(noise_encoder))
    c.noise_encoder = *known;
  else
    file.complain("[model] noise_encoder '" + noise_encoder + "' is not conv_max, conv_average or mlp");
  std::string schedule(beta_schedule_name(o.schedule)), loss = "huber", mask = "none";
  if (architecture != Architecture::facexhubert) {
    file.read("model", "latent", c.latent);
    file.read("model", "diffusion", c.has_diffusion);
    file.read("model", "diffusion_steps", o.diffusion_steps);
    file.read("model", "schedule", schedule);
  }

  file.read("training", "epochs", c.num_epochs);
  file.read("training", "learning_rate", c.learning_rate);
  file.read("training", "loss", loss);
  file.read("training", "teacher_forcing", o.teacher_forcing);
  file.read("training", "frozen", c.frozen);
  file.read("training", "cache_features", o.cache_features);
  file.read("training", "checkpoint_every", c.checkpoint_every);
  file.read("training", "export_every", c.export_every);

  file.read("random", "dropout", o.encoder_dropout);
  file.read("random", "layer_drop", o.layer_drop);
  file.read("random", "spec_augment", o.spec_augment);
  file.read("random", "decoder_dropout", o.decoder_dropout);
  file.read("random", "mask", mask);
  file.read("random", "mask_share", o.mask_share);

  if (const auto known = parse_beta_schedule(schedule))
    o.schedule = *known;
  else
    file.complain("[model] schedule '" + schedule + "' is not cosine or linear");
  if (loss != "huber" && loss != "squared")
    file.complain("[training] loss '" + loss + "' is not huber or squared");
  o.loss = loss == "squared" ? MotionLoss::squared : MotionLoss::huber;
  if (const auto known = parse_audio_mask(mask))
    o.mask = *known;
  else
    file.complain("[random] mask '" + mask +
                  "' is not none, full_zero, full_random, partial_zero or partial_random");
  check(c, file);
  MIEN_TRY([[maybe_unused]] const auto good, file.finish("See configs/" + c.run.system + ".toml"));
  return c;
}

}  // namespace mien::train
