#include <cmath>
#include <nlohmann/json.hpp>

#include "inspect.h"
#include "mien/console/console_exit.h"
#include "mien/core/audio_clip.h"
#include "mien/models/default/default_model.h"
#include "mien/models/model_file.h"
#include "mien/models/said/vae.h"

namespace mien {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t kMostText = 400;  // longer descriptions are left to the file itself

// The members of the training set's description that are short enough to read at a glance.
void add_training_set(const std::string& description, Facts& facts) {
  const Json set = Json::parse(description, nullptr, /*allow_exceptions=*/false);
  if (!set.is_object()) return;
  for (const auto& [key, value] : set.items()) {
    const std::string name = "training_set_" + key;
    if (value.is_string()) {
      facts.add(name, std::string_view(value.get_ref<const std::string&>()).substr(0, kMostText));
    } else if (value.is_number_integer()) {
      facts.add(name, value.get<std::int64_t>());
    } else if (value.is_number()) {
      facts.add(name, value.get<double>(), 2);
    } else if (const std::string text = value.dump(); text.size() <= kMostText) {
      facts.add_table(name, "  " + text + "\n", text);
    }
  }
}

void add_training(const ModelFile& m, Facts& facts) {
  add_training_set(m.training_set, facts);
  if (m.training_config.empty()) return;
  std::string text = "  ";
  for (const char c : m.training_config) {
    text += c;
    if (c == '\n') text += "  ";
  }
  facts.add_table("training_config", text + "\n", json_string(m.training_config));
}

void add_encoder(const EncoderConfig& c, Facts& facts) {
  facts.add("encoder", c.model_type);
  facts.add("encoder_layers", c.num_hidden_layers);
  facts.add("encoder_width", c.hidden_size);
  facts.add("encoder_heads", c.num_attention_heads);
  facts.add("encoder_norm", std::string(c.conv_layer_norm ? "layer" : "group") +
                                (c.do_stable_layer_norm ? ", before each part" : ", after each part"));
  facts.add("encoder_frame_rate_hz", c.frame_rate_hz(), 1, "Hz");
}

// What every model says of itself, in the description's order.
void add_description(const ModelFile& m, const SafetensorsFile& file, Facts& facts) {
  if (m.look_ahead_ms) facts.add("look_ahead_ms", *m.look_ahead_ms, 1, "ms");
  if (m.architecture != Architecture::said_vae) facts.add("sample_rate_hz", std::int64_t{kModelSampleRateHz});
  if (m.architecture != Architecture::speech_encoder) {
    facts.add("space", m.output.space);
    facts.add("fps", m.output.fps, m.output.fps == std::floor(m.output.fps) ? 0 : 3);
    facts.add("channels", m.output.channels);
    if (m.output.space == "vertices") {
      facts.add("vertices", m.output.channels / 3);
      facts.add("topology", m.output.topology.empty() ? "unknown" : m.output.topology);
    }
  }
  if (m.diffusion) {
    facts.add("diffusion_steps", m.diffusion->steps);
    facts.add("noise_schedule", m.diffusion->schedule);
  }
  if (m.encoder) add_encoder(*m.encoder, facts);
  if (m.architecture == Architecture::said_vae) {
    const auto sizes = said::vae_sizes_of(file);
    if (sizes) facts.add("window_frames", sizes->window), facts.add("code", sizes->latent);
  }
  if (m.architecture == Architecture::facediffuser_damm) facts.add("scaler", m.scaler ? "yes" : "no");
}

std::vector<std::string> regions_in(const SafetensorsFile& file) {
  std::vector<std::string> names;
  for (const auto& tensor : file.tensors())
    if (tensor.name.starts_with(ModelFile::kRegionPrefix))
      names.push_back(tensor.name.substr(ModelFile::kRegionPrefix.size()));
  return names;
}

// Weights, without the neutral faces and regions that travel with them.
std::int64_t count_parameters(const SafetensorsFile& file) {
  std::int64_t count = 0;
  for (const auto& tensor : file.tensors())
    if (!tensor.name.starts_with(ModelFile::kTemplatePrefix) &&
        !tensor.name.starts_with(ModelFile::kRegionPrefix))
      count += tensor.count();
  return count;
}

Facts other_tensors(const std::filesystem::path& path, const SafetensorsFile& file) {
  Facts facts;
  facts.add("kind", "tensors");
  facts.add("file", path.string());
  std::string text, json;
  for (const auto& tensor : file.tensors()) {
    std::string shape;
    for (const auto size : tensor.shape) shape += (shape.empty() ? "" : ", ") + std::to_string(size);
    text += "  " + tensor.name + " " + std::string(dtype_name(tensor.dtype)) + " [" + shape + "]\n";
    json += (json.empty() ? "{\"name\":" : ",{\"name\":") + json_string(tensor.name) +
            ",\"dtype\":" + json_string(dtype_name(tensor.dtype)) + ",\"shape\":[" + shape + "]}";
  }
  for (const auto& [key, value] : file.metadata()) facts.add(key, std::string_view(value).substr(0, 400));
  facts.add_table("tensors", std::move(text), "[" + json + "]");
  return facts;
}

}  // namespace

Result<Facts> inspect_model(const std::filesystem::path& path, const SafetensorsFile& file) {
  if (!file.metadata().contains("mien.model")) return other_tensors(path, file);
  const auto fail = [&](const Error& error) { return within(error, "model '" + path.string() + "'"); };
  const auto description = read_model_file(file.metadata());
  if (!description) return fail(description.error());
  const ModelFile& m = *description;
  std::int64_t num_parameters = count_parameters(file);
  if (m.architecture ==
      Architecture::default_model) {  // its statistics are no parameters; its weights are checked
    const auto model = DefaultModel::from_file(file);
    if (!model) return fail(model.error());
    num_parameters = model->num_parameters();
  }
  std::error_code ec;
  Facts facts;
  facts.add("kind", "model");
  facts.add("file", path.string());
  facts.add("name", m.name);
  facts.add("architecture", architecture_name(m.architecture));
  facts.add("format_version", static_cast<std::int64_t>(m.format_version));
  facts.add("parameters", num_parameters);
  facts.add("bytes", static_cast<std::int64_t>(std::filesystem::file_size(path, ec)));
  facts.add("tensors", static_cast<std::int64_t>(file.tensors().size()));
  add_description(m, file, facts);
  for (const auto& [name, size] : m.sizes) facts.add(name, size);
  if (!m.noise_encoder.empty()) facts.add("noise_encoder", m.noise_encoder);
  if (m.architecture == Architecture::default_model) {
    facts.add("styles", m.styles);
  } else if (m.output.space == "vertices") {
    facts.add("subjects", m.subjects);
    facts.add("neutral_faces", template_subjects(file));
    facts.add("regions", regions_in(file));
  }
  if (m.output.space != "vertices" && !m.subjects.empty()) facts.add("subjects", m.subjects);
  if (!m.emotions.empty()) facts.add("emotions", m.emotions);
  if (!m.intensities.empty()) facts.add("intensities", m.intensities);
  if (!m.source.empty()) facts.add("source", m.source);
  facts.add("licence", m.licence);
  add_training(m, facts);
  return facts;
}

}  // namespace mien
