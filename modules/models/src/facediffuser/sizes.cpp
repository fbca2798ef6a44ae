#include <array>
#include <string>

#include "mien/models/facediffuser/network.h"
#include "mien/models/model_file.h"

namespace mien::facediffuser {
namespace {

using Shapes = std::map<std::string, Shape>;

// Axis `axis` of a stored tensor of a given rank; 0 when there is none such.
std::int64_t size_of(const Shapes& shapes, const std::string& name, std::size_t rank, std::size_t axis) {
  const auto stored = shapes.find(name);
  return stored != shapes.end() && stored->second.size() == rank ? stored->second[axis] : 0;
}

constexpr std::array<std::string_view, 3> kNoiseEncoders = {"conv_max", "conv_average", "mlp"};

}  // namespace

std::optional<NoiseEncoder> parse_noise_encoder(std::string_view name) {
  for (std::size_t i = 0; i < kNoiseEncoders.size(); ++i)
    if (kNoiseEncoders[i] == name) return static_cast<NoiseEncoder>(i);
  return std::nullopt;
}

std::string_view noise_encoder_name(NoiseEncoder kind) {
  return kNoiseEncoders[static_cast<std::size_t>(kind)];
}

Result<Sizes> sizes_of(const SafetensorsFile& file, std::optional<bool> styles_speech) {
  return sizes_of(stored_shapes(file), styles_speech);
}

Result<Sizes> sizes_of(const Shapes& shapes, std::optional<bool> styles_speech) {
  Sizes s;
  const auto decoder = stored_decoder(shapes);
  if (decoder) {
    s.hidden = decoder->hidden;
    s.decoder = decoder->sizes;
    s.condition = decoder->input;  // and what else a token holds, taken off below
  }
  if (shapes.contains("out.weight")) {
    s.variant = Variant::damm;
    s.num_channels = size_of(shapes, "out.weight", 2, 0);
    s.latent = size_of(shapes, "embed_timestep.time_embed.0.weight", 2, 0);
    s.num_steps = size_of(shapes, "embed_timestep.sequence_pos_encoder.pe", 3, 0);
  } else {
    s.num_channels = size_of(shapes, "final_layer.weight", 2, 0);
    s.latent = size_of(shapes, "time_mlp.0.weight", 2, 0);
    s.num_steps = size_of(shapes, "time_mlp.0.weight", 2, 1);
    s.variant = shapes.contains("cond_projection.weight") ? Variant::vertices : Variant::beat;
  }
  if (s.variant == Variant::vertices) {
    s.latent = size_of(shapes, "cond_projection.weight", 2, 0);
    s.condition = size_of(shapes, "cond_projection.weight", 2, 1);
    s.num_subjects = size_of(shapes, "obj_vector.weight", 2, 1);
    if (size_of(shapes, "input_projection.1.weight", 2, 0) > 0)
      s.noise_encoder = NoiseEncoder::mlp;
    else if (s.is_diffusion())
      s.num_taps = size_of(shapes, "input_projection.1.weight", 3, 2);
    s.styles_speech = styles_speech.value_or(s.num_subjects == kEmotionalStyle || s.hidden != s.latent);
  } else if (s.is_diffusion()) {
    s.condition -= s.latent + s.num_channels;
  }
  const bool has_styles = s.variant != Variant::vertices || (s.num_subjects > 0 && s.num_taps % 2 == 1 &&
                                                             (s.styles_speech || s.hidden == s.latent));
  if (!decoder || s.num_channels <= 0 || s.hidden <= 0 || s.condition <= 0 || !has_styles ||
      (s.is_diffusion() && s.latent <= 0))
    return Error{
        Errc::incompatible, "weights", "are not those of a denoiser of FaceDiffuser",
        "Expected are its variants V (cond_projection, gru, final_layer), B-BEAT (gru, final_layer) and "
        "B-DAMM (rnn, out), or these with another decoder"};
  return s;
}

}  // namespace mien::facediffuser
