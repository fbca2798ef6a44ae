#include <nlohmann/json.hpp>

#include "inspect.h"
#include "mien/console/console_exit.h"
#include "mien/core/audio_clip.h"
#include "mien/models/default/stream.h"

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

std::vector<std::string> names_in(const SafetensorsFile& file, const char* key) {
  const auto found = file.metadata().find("mien.model");
  if (found == file.metadata().end()) return {};
  const Json json = Json::parse(found->second, nullptr, false);
  std::vector<std::string> names;
  if (json.is_object() && json.contains(key) && json[key].is_array())
    for (const auto& name : json[key])
      if (name.is_string()) names.push_back(name.get<std::string>());
  return names;
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
  const auto model = DefaultModel::from_file(file);
  if (!model) return within(model.error(), "model '" + path.string() + "'");
  const auto& m = model->metadata();
  std::error_code ec;
  Facts facts;
  facts.add("kind", "model");
  facts.add("file", path.string());
  facts.add("name", m.name);
  facts.add("architecture", "default");
  facts.add("format_version", static_cast<std::int64_t>(m.kFormatVersion));
  facts.add("parameters", model->num_parameters());
  facts.add("bytes", static_cast<std::int64_t>(std::filesystem::file_size(path, ec)));
  facts.add("tensors", static_cast<std::int64_t>(file.tensors().size()));
  facts.add("look_ahead_ms", default_model::look_ahead_ms(m), 1, "ms");
  facts.add("sample_rate_hz", std::int64_t{kModelSampleRateHz});
  facts.add("fps", DefaultStream::kFps, 0);
  facts.add("channels", DefaultStream::kNumChannels);
  facts.add("width", m.sizes.width);
  facts.add("condition_width", m.sizes.condition);
  facts.add("diffusion_hidden", m.sizes.diffusion_hidden);
  facts.add("blink_hidden", m.sizes.blink_hidden);
  facts.add("brow_hidden", m.sizes.brow_hidden);
  facts.add("styles", names_in(file, "styles"));
  facts.add("emotions", names_in(file, "emotions"));
  add_training_set(m.training_set, facts);
  if (!m.training_config.empty()) {
    std::string text = "  ";
    for (const char c : m.training_config) {
      text += c;
      if (c == '\n') text += "  ";
    }
    facts.add_table("training_config", text + "\n", json_string(m.training_config));
  }
  return facts;
}

}  // namespace mien
