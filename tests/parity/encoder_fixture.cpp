#include "encoder_fixture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mien/base/file.h"

namespace mien::parity {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) throw std::runtime_error(bytes.error().message());
  return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

constexpr std::string_view kRecorded = ".ref.safetensors", kGradients = "_gradients.ref.safetensors";
constexpr std::string_view kFirstConvolution = "feature_extractor.conv_layers.0.conv.weight";

std::string prefix_of(const fs::path& weights) {
  const auto file = SafetensorsFile::open(weights);
  if (!file) throw std::runtime_error(file.error().message());
  for (const auto& t : file->tensors())
    if (t.name.ends_with(kFirstConvolution))
      return t.name.substr(0, t.name.size() - kFirstConvolution.size());
  throw std::runtime_error(weights.string() + " holds no encoder");
}

}  // namespace

std::vector<EncoderModel> encoder_models() {
  std::vector<EncoderModel> models;
  std::error_code problem;
  for (const auto& entry : fs::directory_iterator(fixture_root() / "encoders", problem)) {
    if (!fs::exists(entry.path() / "config.json") || !fs::exists(entry.path() / "model.safetensors"))
      continue;
    const auto config = encoder_config_from_json(text_of(entry.path() / "config.json"));
    if (!config) throw std::runtime_error(config.error().message());
    EncoderModel model{"encoders/" + entry.path().filename().string(),
                       *config,
                       prefix_of(entry.path() / "model.safetensors"), {}, {}};
    for (const auto& file : fs::directory_iterator(entry.path()))
      if (const std::string name = file.path().filename().string(); name.ends_with(kRecorded))
        (name.ends_with(kGradients) ? model.gradient_files : model.files).push_back(name);
    std::sort(model.files.begin(), model.files.end());
    models.push_back(std::move(model));
  }
  std::sort(models.begin(), models.end(), [](const auto& a, const auto& b) { return a.folder < b.folder; });
  return models;
}

EncoderCase::EncoderCase(const EncoderModel& model, const std::string& file) : recorded(model.folder, file) {
  const Tensor samples = recorded.tensor("input_values");
  waveform = samples.reshaped({samples.count(), 1});
  if (recorded.has("num_frames")) num_frames_ = recorded.integers("num_frames").at(0);
  if (recorded.has("attention_mask_samples")) {
    const auto flags = recorded.file().as<std::uint8_t>("attention_mask_samples");
    const auto count = std::count_if(flags->begin(), flags->end(), [](std::uint8_t f) { return f != 0; });
    valid_.push_back(model.config.num_frames(count));
  }
  if (recorded.has("mask_time_indices")) {
    const auto flags = recorded.file().as<std::uint8_t>("mask_time_indices");
    masked_.assign(flags->begin(), flags->end());
  }
}

EncoderCall EncoderCase::call() const { return {num_frames_, valid_, masked_, {}}; }

std::vector<float> recipe_values(const std::string& name, const Shape& shape, std::uint64_t salt) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  std::int64_t count = 1, fan_in = 1;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    count *= shape[i];
    if (i > 0) fan_in *= shape[i];
  }
  float offset = 0, factor = 0;
  if (name.ends_with(".bias"))
    factor = 0.125f;
  else if (name.ends_with("layer_norm.weight"))
    offset = 1, factor = 0.25f;
  else if (name.ends_with("weight_g"))
    offset = 2, factor = 0.5f;
  else if (name == "masked_spec_embed")
    factor = 1;
  else
    factor = static_cast<float>(std::sqrt((name.find(".conv.weight") != std::string::npos ? 6.0 : 3.0) /
                                          static_cast<double>(fan_in)));
  std::vector<float> values(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::uint64_t z = (hash ^ salt) + (i + 1) * 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    z ^= z >> 31;
    const float r = static_cast<float>(static_cast<std::int64_t>(z >> 40) - 8388608) / 8388608.0f;
    values[i] = offset == 0 ? r * factor : offset + r * factor;
  }
  return values;
}

}  // namespace mien::parity
