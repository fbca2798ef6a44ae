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

}  // namespace mien
