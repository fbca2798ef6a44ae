#include "mien/models/default/model_metadata.h"

#include <nlohmann/json.hpp>

namespace mien::default_model {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kKey = "mien.model";
constexpr const char* kArchitecture = "default";

}  // namespace

double look_ahead_ms(const ModelMetadata& metadata) {
  constexpr double kInterpolation = 20.0 / 3, kHalfWindow = 12.5, kSmoother = 100.0 / 3;
  return 10.0 * static_cast<double>(metadata.look_ahead_mel_frames) + kInterpolation + kHalfWindow +
         kSmoother;
}

std::map<std::string, std::string> to_metadata(const ModelMetadata& m) {
  Json json;
  json["format_version"] = ModelMetadata::kFormatVersion;
  json["architecture"] = kArchitecture;
  json["name"] = m.name;
  json["input"] = {{"sample_rate_hz", 16000}, {"features", "log-mel 64 at 100 Hz, running level"}};
  json["output"] = {{"space", "arkit"}, {"channels", 55}, {"fps", 60}};
  json["look_ahead_ms"] = look_ahead_ms(m);
  json["sizes"] = {{"width", m.sizes.width},
                   {"condition", m.sizes.condition},
                   {"diffusion_hidden", m.sizes.diffusion_hidden},
                   {"blink_hidden", m.sizes.blink_hidden},
                   {"brow_hidden", m.sizes.brow_hidden}};
  json["look_ahead_mel_frames"] = m.look_ahead_mel_frames;
  json["styles"] = Json::array();
  for (int s = 0; s < kStyleEntries - 1; ++s)
    json["styles"].push_back((s < 10 ? "S0" : "S") + std::to_string(s));
  json["emotions"] = {"neutral", "happy", "sad", "surprised", "fear", "disgusted", "angry", "contempt"};
  json["licence"] = "Apache-2.0; trained on speech made by synthesisers, see docs/corpus.md";
  json["training"] = {{"config", m.training_config}, {"set", m.training_set}};
  return {{kKey, json.dump()}};
}

Result<ModelMetadata> from_metadata(const std::map<std::string, std::string>& metadata) {
  const auto found = metadata.find(kKey);
  if (found == metadata.end())
    return Error{Errc::incompatible, "model", "holds no description of a Mien model",
                 "Use a file that `mien train` wrote, or import it first"};
  const Json json = Json::parse(found->second, nullptr, /*allow_exceptions=*/false);
  const auto broken = [](const std::string& why) {
    return Error{Errc::incompatible, "model description", why, "The file may be damaged"};
  };
  if (!json.is_object()) return broken("is not a JSON object");
  ModelMetadata m;
  bool has_all_sizes = false;
  try {
    const int version = json.at("format_version").get<int>();
    if (version > ModelMetadata::kFormatVersion)
      return Error{Errc::incompatible, "model",
                   "has format version " + std::to_string(version) + ", this program reads up to " +
                       std::to_string(ModelMetadata::kFormatVersion),
                   "Use a newer Mien"};
    if (const auto architecture = json.at("architecture").get<std::string>(); architecture != kArchitecture)
      return Error{Errc::incompatible, "model",
                   "has the architecture '" + architecture + "', expected 'default'", ""};
    m.name = json.at("name").get<std::string>();
    const auto& sizes = json.at("sizes");
    const auto size = [&](const char* key) {
      const auto value = sizes.at(key).get<std::int64_t>();
      return value >= 1 && value <= 4096 ? value : 0;
    };
    m.sizes = {size("width"), size("condition"), size("diffusion_hidden"), size("blink_hidden"),
               version == 1 ? 0 : size("brow_hidden")};
    has_all_sizes = m.sizes.width > 0 && m.sizes.condition > 0 && m.sizes.diffusion_hidden > 0 &&
                    m.sizes.blink_hidden > 0 && (version == 1 || m.sizes.brow_hidden > 0);
    m.look_ahead_mel_frames = json.at("look_ahead_mel_frames").get<std::int64_t>();
    m.training_config = json.at("training").at("config").get<std::string>();
    m.training_set = json.at("training").at("set").get<std::string>();
  } catch (const Json::exception& e) {
    return broken(e.what());
  }
  if (!has_all_sizes) return broken("a layer size is not within 1 ... 4096");
  if (m.look_ahead_mel_frames < 0 || m.look_ahead_mel_frames > 100)
    return broken("the look-ahead is not within 0 ... 1 s");
  return m;
}

}  // namespace mien::default_model
