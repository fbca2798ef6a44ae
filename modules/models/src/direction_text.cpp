// Direction over time from text: CSV and JSON.
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "mien/base/number_text.h"
#include "mien/models/direction.h"

namespace mien {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const auto at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// One key in words; `style` may be empty.
struct KeyWords {
  std::optional<double> seconds;
  std::string emotion, intensity, style;
};

// Appends a key, or blends it with the last one of the same time.
Status add_key(const KeyWords& words, std::vector<DirectionKey>& keys) {
  if (!words.seconds || !(*words.seconds >= 0) || !std::isfinite(*words.seconds))
    return Error{Errc::input, "time", "is not a number of seconds from 0 on", ""};
  const auto intensities = parse_emotion_intensity(words.emotion + ":" + words.intensity);
  if (!intensities) return intensities.error();
  DirectionKey key{*words.seconds, *intensities, -1};
  if (!words.style.empty()) {
    MIEN_TRY(key.style, parse_style(words.style));
  }
  if (!keys.empty() && key.seconds == keys.back().seconds) {
    for (std::size_t e = 0; e < key.intensities.size(); ++e) keys.back().intensities[e] += key.intensities[e];
    return Done{};
  }
  if (!keys.empty() && key.seconds < keys.back().seconds)
    return Error{Errc::input, "time", "is earlier than that of the key before", "Sort the keys by time"};
  keys.push_back(key);
  return Done{};
}

Error at_place(Error error, const std::string& place) {
  error.code = Errc::input;  // a wrong word in a file is not wrong usage
  return within(std::move(error), place);
}

Result<Direction> direction_of(std::vector<DirectionKey> keys) {
  if (keys.empty())
    return Error{Errc::input, "direction", "holds no keys", "Write lines such as 0.0,happy,0.5"};
  return Direction(std::move(keys));
}

std::optional<KeyWords> key_words(const nlohmann::json& key) {
  if (!key.is_object()) return std::nullopt;
  KeyWords words;
  for (const auto& [name, value] : key.items()) {
    if (name == "time" && value.is_number()) {
      words.seconds = value.get<double>();
    } else if (name == "emotion" && value.is_string()) {
      words.emotion = value.get<std::string>();
    } else if (name == "intensity" && value.is_number()) {
      words.intensity = value.dump();  // keeps 1 (a level) apart from 1.0
    } else if (name == "style" && value.is_string()) {
      words.style = value.get<std::string>();
    } else {
      return std::nullopt;
    }
  }
  return words;
}

}  // namespace

Result<Direction> parse_direction_csv(std::string_view text) {
  const auto lines = split(text, '\n');
  bool has_header = false;
  std::vector<DirectionKey> keys;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string_view line = trimmed(lines[i]);
    if (line.empty()) continue;
    const std::string where = "line " + std::to_string(i + 1);
    auto fields = split(line, ',');
    for (auto& field : fields) field = trimmed(field);
    if (!has_header) {
      if (fields.size() < 3 || fields[0] != "time" || fields[1] != "emotion" || fields[2] != "intensity")
        return Error{Errc::input, where, "expected the header time,emotion,intensity[,style]", ""};
      has_header = true;
      continue;
    }
    if (fields.size() < 3 || fields.size() > 4)
      return Error{Errc::input, where, "has " + std::to_string(fields.size()) + " fields, expected 3 or 4",
                   ""};
    const KeyWords words{parse_double(fields[0]), std::string(fields[1]), std::string(fields[2]),
                         fields.size() == 4 ? std::string(fields[3]) : ""};
    if (const auto added = add_key(words, keys); !added) return at_place(added.error(), where);
  }
  return direction_of(std::move(keys));
}

Result<Direction> parse_direction_json(std::string_view text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_array()) return Error{Errc::input, "direction", "is not a JSON list of keys", ""};
  std::vector<DirectionKey> keys;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string where = "key " + std::to_string(i + 1);
    const auto words = key_words(json[i]);
    if (!words)
      return Error{Errc::input, where,
                   "is not an object with the members time, emotion, intensity and perhaps style", ""};
    if (const auto added = add_key(*words, keys); !added) return at_place(added.error(), where);
  }
  return direction_of(std::move(keys));
}

}  // namespace mien
