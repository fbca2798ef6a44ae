#include <charconv>
#include <nlohmann/json.hpp>

#include "mien/corpus/corpus_files.h"

namespace mien {
namespace {

using Json = nlohmann::ordered_json;

std::string hex(std::uint64_t value) {
  char text[17];
  const auto end = std::to_chars(text, text + 16, value, 16).ptr;
  return std::string(text, end);
}

}  // namespace

std::string format_info(const CorpusInfo& info) {
  Json json;
  json["version"] = info.version;
  json["seed"] = hex(info.seed);
  json["fps"] = info.fps;
  json["sample_rate"] = info.sample_rate_hz;
  json["channels"] = info.channels;
  json["engines"] = info.engines;
  json["table_hash"] = hex(info.generator_hash);
  json["items"] = info.items_of_split;
  return json.dump(1) + "\n";
}

Result<CorpusInfo> parse_info(std::string_view text, std::string_view name) {
  const auto bad = [&](std::string why) { return Error{Errc::input, std::string(name), std::move(why), ""}; };
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return bad("is no JSON object");
  const auto field = [&](const char* key) { return json.contains(key) ? json.at(key) : Json(); };
  const auto hex_value = [&](const char* key) -> std::optional<std::uint64_t> {
    const Json value = field(key);
    if (!value.is_string()) return std::nullopt;
    const auto digits = value.get<std::string>();
    std::uint64_t number = 0;
    const auto end = digits.data() + digits.size();
    const auto parsed = std::from_chars(digits.data(), end, number, 16);
    if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
    return number;
  };

  CorpusInfo info;
  if (field("version") != Json(info.version)) return bad("\"version\" must be 1");
  const auto seed = hex_value("seed"), hash = hex_value("table_hash");
  if (!seed || !hash) return bad("\"seed\" and \"table_hash\" must be hexadecimal texts");
  info.seed = *seed;
  info.generator_hash = *hash;
  if (field("fps") != Json(info.fps)) return bad("\"fps\" must be 60");
  if (field("sample_rate") != Json(info.sample_rate_hz)) return bad("\"sample_rate\" must be 16000");
  const Json channels = field("channels"), engines = field("engines"), items = field("items");
  if (!channels.is_array() || !engines.is_object() || !items.is_object())
    return bad("\"channels\" must be a list, \"engines\" and \"items\" must be objects");
  for (const Json& channel : channels) {
    if (!channel.is_string()) return bad("\"channels\" must hold texts");
    info.channels.push_back(channel);
  }
  for (const auto& [key, value] : engines.items()) {
    if (!value.is_string()) return bad("\"engines\" must hold texts");
    info.engines[key] = value;
  }
  for (const auto& [key, value] : items.items()) {
    if (!value.is_number_unsigned()) return bad("\"items\" must hold counts");
    info.items_of_split[key] = value;
  }
  return info;
}

}  // namespace mien
