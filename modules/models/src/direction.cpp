#include "mien/models/direction.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "mien/base/contract.h"
#include "mien/base/number_text.h"

namespace mien {
namespace {

constexpr int kNumStyles = 12;

std::string known_emotions() {
  std::string list;
  for (const auto name : emotion_names()) list += (list.empty() ? "" : ", ") + std::string(name);
  return list;
}

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

}  // namespace

Direction::Direction(std::vector<DirectionKey> keys) : keys_(std::move(keys)) {
  contract(!keys_.empty(), "Direction: at least one key is needed");
  for (std::size_t i = 1; i < keys_.size(); ++i)
    contract(keys_[i].seconds > keys_[i - 1].seconds, "Direction: times must increase");
}

Direction::Between Direction::at(double seconds) const {
  const auto after = std::upper_bound(keys_.begin(), keys_.end(), seconds,
                                      [](double t, const DirectionKey& key) { return t < key.seconds; });
  if (after == keys_.begin()) return {&keys_.front(), &keys_.front(), 0};
  const auto before = after - 1;
  if (after == keys_.end()) return {&*before, &*before, 0};
  return {&*before, &*after,
          static_cast<float>((seconds - before->seconds) / (after->seconds - before->seconds))};
}

float Direction::strength(double seconds) const {
  const Between b = at(seconds);
  const auto sum = [](const DirectionKey& key) {
    float total = 0;
    for (std::size_t e = 1; e < key.intensities.size(); ++e) total += key.intensities[e];
    return total;
  };
  return std::min(1.0f, std::lerp(sum(*b.first), sum(*b.second), b.weight));
}

Result<std::array<float, kNumEmotions>> parse_emotion_intensity(std::string_view text) {
  const auto colon = text.find(':');
  const std::string_view name = text.substr(0, colon);
  const auto emotion = parse_emotion(name);
  if (!emotion)
    return Error{Errc::usage, "emotion '" + std::string(name) + "'", "is not known",
                 "Known: " + known_emotions()};
  std::array<float, kNumEmotions> intensities{};
  float intensity = 1;
  if (colon != std::string_view::npos) {
    const std::string_view number = text.substr(colon + 1);
    const auto value = parse_double(number);
    const bool is_level = number == "1" || number == "2" || number == "3";
    if (!value || (!is_level && !(*value >= 0 && *value <= 1)))
      return Error{Errc::usage, "intensity '" + std::string(number) + "'",
                   "is not a level 1, 2, 3 or a number 0.0 ... 1.0", "For example angry:2 or angry:0.65"};
    intensity = is_level ? intensity_of_level(static_cast<int>(*value)) : static_cast<float>(*value);
  }
  if (*emotion != Emotion::neutral) intensities[static_cast<std::size_t>(*emotion)] = intensity;
  return intensities;
}

Result<int> parse_style(std::string_view text) {
  if (text.size() == 3 && text[0] == 'S')
    if (const auto index = parse_int(text.substr(1)); index && *index >= 0 && *index < kNumStyles)
      return static_cast<int>(*index);
  return Error{Errc::usage, "style '" + std::string(text) + "'", "is not known", "Known: S00 ... S11"};
}

Result<Direction> parse_direction_csv(std::string_view text) {
  const auto lines = split(text, '\n');
  std::vector<std::string_view> header;
  std::vector<DirectionKey> keys;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string_view line = trimmed(lines[i]);
    if (line.empty()) continue;
    const std::string where = "line " + std::to_string(i + 1);
    auto fields = split(line, ',');
    for (auto& field : fields) field = trimmed(field);
    if (header.empty()) {
      header = fields;
      if (header.size() < 3 || header[0] != "time" || header[1] != "emotion" || header[2] != "intensity")
        return Error{Errc::input, where, "expected the header time,emotion,intensity[,style]", ""};
      continue;
    }
    if (fields.size() < 3 || fields.size() > 4)
      return Error{Errc::input, where, "has " + std::to_string(fields.size()) + " fields, expected 3 or 4",
                   ""};
    const auto time = parse_double(fields[0]);
    if (!time || !(*time >= 0))
      return Error{Errc::input, where, "'" + std::string(fields[0]) + "' is not a time in seconds", ""};
    auto intensities = parse_emotion_intensity(std::string(fields[1]) + ":" + std::string(fields[2]));
    if (!intensities) {
      Error error = within(intensities.error(), where);
      error.code = Errc::input;
      return error;
    }
    DirectionKey key{*time, *intensities, -1};
    if (fields.size() == 4 && !fields[3].empty()) {
      const auto style = parse_style(fields[3]);
      if (!style) return Error{Errc::input, where, style.error().message(), ""};
      key.style = *style;
    }
    if (!keys.empty() && key.seconds == keys.back().seconds) {  // a blend of emotions
      for (std::size_t e = 0; e < key.intensities.size(); ++e)
        keys.back().intensities[e] += key.intensities[e];
      continue;
    }
    if (!keys.empty() && key.seconds < keys.back().seconds)
      return Error{Errc::input, where, "its time is earlier than that of the line before",
                   "Sort the lines by time"};
    keys.push_back(key);
  }
  if (keys.empty())
    return Error{Errc::input, "direction", "holds no keys", "Write lines such as 0.0,happy,0.5"};
  return Direction(std::move(keys));
}

}  // namespace mien
