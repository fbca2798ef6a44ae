#include "mien/models/model_file.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mien/base/contract.h"

namespace mien {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kKey = "mien.model";
constexpr std::array<std::string_view, 11> kArchitectures = {
    "default",           "speech_encoder", "facexhubert", "facediffuser_v",       "facediffuser_beat",
    "facediffuser_damm", "said_vae",       "said",        "facediffuser_emotion", "probtalk3d",
    "probtalk3d_prior"};
// Whether a model hears speech with an encoder that its file describes.
constexpr bool has_encoder(Architecture architecture) {
  return architecture != Architecture::default_model && architecture != Architecture::said_vae &&
         architecture != Architecture::probtalk3d_prior;
}
constexpr std::int64_t kMostChannels = 30'000'000, kMostSteps = 1'000'000;
constexpr double kMostFps = 1000;

Error broken(const std::string& why) {
  return {Errc::incompatible, "model description", why, "The file may be damaged"};
}

// Members that may be absent. A wrong type throws, and read_model_file() catches.
template <class T>
void read(const Json& json, const char* key, T& value) {
  if (const auto found = json.find(key); found != json.end()) value = found->get<T>();
}
template <class T>
void read(const Json& json, const char* key, std::optional<T>& value) {
  if (const auto found = json.find(key); found != json.end()) value = found->get<T>();
}

std::optional<Architecture> find_architecture(std::string_view name) {
  for (std::size_t i = 0; i < kArchitectures.size(); ++i)
    if (kArchitectures[i] == name) return static_cast<Architecture>(i);
  return std::nullopt;
}

Status check(const ModelFile& m) {
  const bool moves = m.architecture != Architecture::speech_encoder;
  if (moves && (m.output.channels < 1 || m.output.channels > kMostChannels))
    return broken("the number of output channels is not within 1 ... 30 million");
  if (moves && !(m.output.fps > 0 && m.output.fps <= kMostFps))
    return broken("the frame rate is not within 0 ... 1000");
  if (m.output.space == "vertices" && m.output.channels % 3 != 0)
    return broken("the channels of vertices are not a multiple of 3");
  if (m.diffusion && (m.diffusion->steps < 1 || m.diffusion->steps > kMostSteps))
    return broken("the number of diffusion steps is not within 1 ... 1 million");
  if (m.diffusion && m.diffusion->schedule != "cosine" && m.diffusion->schedule != "linear")
    return broken("the noise schedule '" + m.diffusion->schedule + "' is not known");
  if (!m.scaler) return Done{};
  const auto channels = static_cast<std::size_t>(m.output.channels);
  if (m.scaler->scale.size() != channels || m.scaler->min.size() != channels)
    return broken("the scaler has another number of channels than the output");
  for (std::size_t c = 0; c < channels; ++c)
    if (!std::isfinite(m.scaler->min[c]) || !std::isfinite(m.scaler->scale[c]) || m.scaler->scale[c] == 0)
      return broken("the scaler's channel " + std::to_string(c) + " has no inverse");
  return Done{};
}

// In version 1 and 2 all of a file's members are written in this order; absent ones are left out.
Json to_json(const ModelFile& m) {
  Json json;
  json["format_version"] = m.format_version;
  json["architecture"] = architecture_name(m.architecture);
  json["name"] = m.name;
  if (m.architecture != Architecture::said_vae) json["input"] = {{"sample_rate_hz", 16000}};
  if (!m.input.empty()) json["input"]["features"] = m.input;
  if (m.architecture != Architecture::speech_encoder) {
    json["output"] = {{"space", m.output.space}, {"channels", m.output.channels}};
    if (m.output.fps == std::floor(m.output.fps))
      json["output"]["fps"] = static_cast<std::int64_t>(m.output.fps);
    else
      json["output"]["fps"] = m.output.fps;
    if (!m.output.topology.empty()) json["output"]["topology"] = m.output.topology;
  }
  if (m.look_ahead_ms) json["look_ahead_ms"] = *m.look_ahead_ms;
  if (!m.sizes.empty()) json["sizes"] = m.sizes;
  if (m.look_ahead_mel_frames) json["look_ahead_mel_frames"] = *m.look_ahead_mel_frames;
  if (m.encoder) json["encoder"] = Json::parse(to_json(*m.encoder));
  if (m.diffusion) json["diffusion"] = {{"schedule", m.diffusion->schedule}, {"steps", m.diffusion->steps}};
  if (!m.noise_encoder.empty()) json["noise_encoder"] = m.noise_encoder;
  if (m.scaler) json["scaler"] = {{"scale", m.scaler->scale}, {"min", m.scaler->min}};
  if (!m.styles.empty()) json["styles"] = m.styles;
  if (!m.subjects.empty()) json["subjects"] = m.subjects;
  if (!m.emotions.empty()) json["emotions"] = m.emotions;
  if (!m.intensities.empty()) json["intensities"] = m.intensities;
  json["licence"] = m.licence;
  if (!m.source.empty()) json["source"] = m.source;
  if (!m.training_config.empty() || !m.training_set.empty() || m.architecture == Architecture::default_model)
    json["training"] = {{"config", m.training_config}, {"set", m.training_set}};
  return json;
}

Status read_json(const Json& json, ModelFile& m) {
  m.format_version = json.at("format_version").get<int>();
  if (m.format_version > ModelFile::kFormatVersion)
    return Error{Errc::incompatible, "model",
                 "has format version " + std::to_string(m.format_version) + ", this program reads up to " +
                     std::to_string(ModelFile::kFormatVersion),
                 "Use a newer Mien"};
  const auto architecture = json.at("architecture").get<std::string>();
  const auto known = find_architecture(architecture);
  if (!known)
    return Error{Errc::incompatible, "model",
                 "has the architecture '" + architecture + "', which this program does not know",
                 "Use a newer Mien"};
  m.architecture = *known;
  m.name = json.at("name").get<std::string>();
  if (const auto input = json.find("input"); input != json.end()) read(*input, "features", m.input);
  if (m.architecture != Architecture::speech_encoder) {
    const auto& output = json.at("output");
    m.output.space = output.at("space").get<std::string>();
    m.output.channels = output.at("channels").get<std::int64_t>();
    m.output.fps = output.at("fps").get<double>();
    read(output, "topology", m.output.topology);
  }
  if (has_encoder(m.architecture)) {
    MIEN_TRY(m.encoder, encoder_config_from_json(json.at("encoder").dump()));
  }
  if (const auto diffusion = json.find("diffusion"); diffusion != json.end())
    m.diffusion = {diffusion->at("schedule").get<std::string>(), diffusion->at("steps").get<std::int64_t>()};
  if (const auto scaler = json.find("scaler"); scaler != json.end())
    m.scaler = {scaler->at("scale").get<std::vector<double>>(), scaler->at("min").get<std::vector<double>>()};
  read(json, "noise_encoder", m.noise_encoder);
  read(json, "sizes", m.sizes);
  read(json, "look_ahead_mel_frames", m.look_ahead_mel_frames);
  read(json, "look_ahead_ms", m.look_ahead_ms);
  read(json, "styles", m.styles);
  read(json, "subjects", m.subjects);
  read(json, "emotions", m.emotions);
  read(json, "intensities", m.intensities);
  read(json, "licence", m.licence);
  read(json, "source", m.source);
  if (const auto training = json.find("training"); training != json.end()) {
    m.training_config = training->at("config").get<std::string>();
    m.training_set = training->at("set").get<std::string>();
  }
  return check(m);
}

}  // namespace

std::string_view architecture_name(Architecture architecture) {
  return kArchitectures[static_cast<std::size_t>(architecture)];
}

void apply_scaler(const ModelScaler& scaler, std::span<float> rows) {
  const std::size_t width = scaler.scale.size();
  contract(width > 0 && rows.size() % width == 0, "apply_scaler: not whole rows");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto scaled = static_cast<float>(static_cast<double>(rows[i]) * scaler.scale[i % width]);
    rows[i] = static_cast<float>(static_cast<double>(scaled) + scaler.min[i % width]);
  }
}

void undo_scaler(const ModelScaler& scaler, std::span<float> rows) {
  const std::size_t width = scaler.scale.size();
  contract(width > 0 && rows.size() % width == 0, "undo_scaler: not whole rows");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto moved = static_cast<float>(static_cast<double>(rows[i]) - scaler.min[i % width]);
    rows[i] = static_cast<float>(static_cast<double>(moved) / scaler.scale[i % width]);
  }
}

Metadata to_metadata(const ModelFile& model) {
  return {{kKey, to_json(model).dump(-1, ' ', false, Json::error_handler_t::replace)}};
}

Result<ModelFile> read_model_file(const Metadata& metadata) {
  const auto found = metadata.find(kKey);
  if (found == metadata.end())
    return Error{Errc::incompatible, "model", "holds no description of a Mien model",
                 "Use a file that `mien train` or `mien import` wrote"};
  const Json json = Json::parse(found->second, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return broken("is not a JSON object");
  ModelFile model;
  try {
    MIEN_TRY([[maybe_unused]] const auto read, read_json(json, model));
  } catch (const Json::exception& e) {
    return broken(e.what());
  }
  return model;
}

std::vector<std::string> template_subjects(const SafetensorsFile& file) {
  std::vector<std::string> subjects;
  for (const auto& tensor : file.tensors())
    if (tensor.name.starts_with(ModelFile::kTemplatePrefix))
      subjects.push_back(tensor.name.substr(ModelFile::kTemplatePrefix.size()));
  return subjects;
}

Result<std::vector<float>> read_template(const SafetensorsFile& file, std::string_view subject) {
  const std::string name = std::string(ModelFile::kTemplatePrefix) + std::string(subject);
  if (file.find(name) != nullptr) return file.read_float(name);
  std::string known;
  for (const auto& other : template_subjects(file)) known += (known.empty() ? "" : ", ") + other;
  return Error{Errc::incompatible, "subject '" + std::string(subject) + "'",
               "has no neutral face in the model",
               known.empty() ? "Import the model with --templates" : "The model has: " + known};
}

std::map<std::string, Shape> stored_shapes(const SafetensorsFile& file) {
  std::map<std::string, Shape> shapes;
  for (const auto& tensor : file.tensors()) shapes.emplace(tensor.name, tensor.shape);
  return shapes;
}

}  // namespace mien
