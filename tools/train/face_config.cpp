#include "face_config.h"

#include "config_fields.h"

namespace mien::train {
namespace {

// Specifications of FaceDiffuser (sections 1, 6, 11, 14), FaceXHuBERT (sections 1 and 5) and ProbTalk3D
// (section 10).
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
    case Architecture::facediffuser_emotion:
      c.latent = c.hidden = 256;
      c.options.diffusion_steps = 1000;
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

// Fields that only go with others.
void check(const FaceConfig& c, TomlFile& file) {
  if (c.decoder.kind == DecoderKind::transformer && c.decoder.heads >= 1 && c.hidden % c.decoder.heads != 0)
    file.complain("[model] hidden must be a multiple of heads");
  if (c.options.teacher_forcing && c.decoder.kind != DecoderKind::transformer)
    file.complain("[training] teacher_forcing is for the decoder 'transformer'");
  const bool is_tied =
      c.architecture == Architecture::facediffuser_v || c.architecture == Architecture::facediffuser_damm;
  if (is_tied && c.latent != c.hidden)
    file.complain("[model] latent and hidden must be equal in this system");
}

void read_model(TomlFile& file, FaceConfig& c) {
  auto& o = c.options;
  file.read_word("model", "decoder", c.decoder.kind, parse_decoder_kind, "gru, rnn, lstm or transformer");
  if (c.decoder.kind == DecoderKind::transformer) {  // of the thesis' vanilla transformer, and PyTorch's own
    c.decoder.num_layers = 1;
    o.decoder_dropout = 0.1;
  }
  file.read("model", "hidden", c.hidden, at_least(1));
  file.read("model", "layers", c.decoder.num_layers, at_least(1));
  file.read("model", "heads", c.decoder.heads, at_least(1));
  if (c.has_vertex_denoiser())
    file.read_word("model", "noise_encoder", c.noise_encoder, facediffuser::parse_noise_encoder,
                   "conv_max, conv_average or mlp");
  if (c.architecture == Architecture::facexhubert) return;
  file.read("model", "latent", c.latent, at_least(1));
  file.read("model", "diffusion", c.has_diffusion);
  read_diffusion(file, o.schedule, o.diffusion_steps);
}

}  // namespace

Result<FaceConfig> read_face_config(TomlFile& file, Architecture architecture) {
  FaceConfig c = published(architecture);
  c.run.read(file);
  auto& o = c.options;
  o.seed = c.run.seed;
  read_encoder_choice(file, c.encoder);
  file.read("run", "subjects", c.subjects);
  read_corpus_fields(file, c.corpus);
  if (architecture != Architecture::facediffuser_emotion) file.read("run", "layout", c.layout);
  read_model(file, c);
  bool is_squared = false;
  file.read("training", "epochs", c.num_epochs, at_least(1));
  file.read("training", "learning_rate", c.learning_rate, above_zero());
  read_is_squared(file, is_squared, "huber");
  o.loss = is_squared ? MotionLoss::squared : MotionLoss::huber;
  file.read("training", "teacher_forcing", o.teacher_forcing);
  file.read("training", "frozen", c.frozen);
  file.read("training", "cache_features", o.cache_features);
  file.read("training", "checkpoint_every", c.checkpoint_every, at_least(1));
  file.read("training", "export_every", c.export_every, not_negative());
  file.read("random", "dropout", o.encoder_dropout);
  file.read("random", "layer_drop", o.layer_drop);
  file.read("random", "spec_augment", o.spec_augment);
  file.read("random", "decoder_dropout", o.decoder_dropout, share_below_one());
  file.read_word("random", "mask", o.mask, parse_audio_mask,
                 "none, full_zero, full_random, partial_zero or partial_random");
  file.read("random", "mask_share", o.mask_share, share_below_one());
  check(c, file);
  MIEN_TRY([[maybe_unused]] const auto good, file.finish("See configs/" + c.run.system + ".toml"));
  return c;
}

}  // namespace mien::train
