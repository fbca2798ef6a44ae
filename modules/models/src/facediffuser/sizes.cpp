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

std::int64_t count_layers(const Shapes& shapes, const std::string& gru) {
  std::int64_t count = 0;
  while (shapes.contains(gru + ".weight_ih_l" + std::to_string(count))) ++count;
  return count;
}

}  // namespace

Result<Sizes> sizes_of(const SafetensorsFile& file, std::optional<bool> styles_speech) {
  return sizes_of(stored_shapes(file), styles_speech);
}

Result<Sizes> sizes_of(const Shapes& shapes, std::optional<bool> styles_speech) {
  Sizes s;
  const bool is_damm = shapes.contains("rnn.weight_ih_l0");
  const std::string gru = is_damm ? "rnn" : "gru";
  s.hidden = size_of(shapes, gru + ".weight_hh_l0", 2, 1);
  s.num_layers = count_layers(shapes, gru);
  const std::int64_t input = size_of(shapes, gru + ".weight_ih_l0", 2, 1);
  if (is_damm) {
    s.variant = Variant::damm;
    s.num_channels = size_of(shapes, "out.weight", 2, 0);
    s.latent = size_of(shapes, "embed_timestep.time_embed.0.weight", 2, 0);
    s.num_steps = size_of(shapes, "embed_timestep.sequence_pos_encoder.pe", 3, 0);
    s.condition = input - s.latent - s.num_channels;
  } else {
    s.num_channels = size_of(shapes, "final_layer.weight", 2, 0);
    s.latent = size_of(shapes, "time_mlp.0.weight", 2, 0);
    s.num_steps = size_of(shapes, "time_mlp.0.weight", 2, 1);
    if (shapes.contains("input_projection.0.weight")) {
      s.variant = Variant::vertices;
      s.condition = size_of(shapes, "cond_projection.weight", 2, 1);
      s.num_subjects = size_of(shapes, "obj_vector.weight", 2, 1);
      s.num_taps = size_of(shapes, "input_projection.1.weight", 3, 2);
      s.styles_speech = styles_speech.value_or(s.num_subjects == kEmotionalStyle || s.hidden != s.latent);
    } else {
      s.variant = Variant::beat;
      s.condition = input - s.latent - s.num_channels;
    }
  }
  const bool has_styles = s.variant != Variant::vertices || (s.num_subjects > 0 && s.num_taps % 2 == 1 &&
                                                             (s.styles_speech || s.hidden == s.latent));
  if (s.num_channels <= 0 || s.latent <= 0 || s.hidden <= 0 || s.num_layers <= 0 || s.num_steps <= 0 ||
      s.condition <= 0 || !has_styles)
    return Error{
        Errc::incompatible, "weights", "are not those of a denoiser of FaceDiffuser",
        "Expected are its variants V (input_projection, gru, final_layer), B-BEAT (gru, final_layer) and "
        "B-DAMM (rnn, out)"};
  return s;
}

}  // namespace mien::facediffuser
