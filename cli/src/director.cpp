#include "director.h"

#include <filesystem>

#include "mien/base/file.h"
#include "nearest_name.h"

namespace mien {
namespace {

bool names_a_file(const std::string& word) {
  std::error_code ec;
  return word.ends_with(".csv") || word.ends_with(".json") || word.find('/') != std::string::npos ||
         std::filesystem::is_regular_file(word, ec);
}

Result<Direction> read_direction(const std::string& path) {
  MIEN_TRY(const Bytes bytes, read_file(path));
  auto direction =
      path.ends_with(".json") ? parse_direction_json(as_text(bytes)) : parse_direction_csv(as_text(bytes));
  if (!direction) return within(direction.error(), "direction '" + path + "'");
  return direction;
}

Result<Direction> constant_emotion(const std::string& word) {
  DirectionKey key;
  if (!word.empty()) {
    auto intensities = parse_emotion_intensity(word);
    if (!intensities) {
      Error error = intensities.error();
      std::vector<std::string> names(emotion_names().begin(), emotion_names().end());
      const auto name = word.substr(0, word.find(':'));
      const auto near = nearest_name(name, names);
      if (!near.empty() && near != name) error.fix = "Did you mean " + near + "? " + error.fix;
      return within(error, "--emotion");
    }
    key.intensities = *intensities;
  }
  return Direction({key});
}

}  // namespace

Result<PerformOptions> perform_options(const DirectionWords& words) {
  PerformOptions options;
  MIEN_TRY(const Direction emotions,
           names_a_file(words.emotion) ? read_direction(words.emotion) : constant_emotion(words.emotion));
  std::vector<DirectionKey> keys = emotions.keys();
  if (!words.style.empty()) {
    const auto style = parse_style(words.style);
    if (!style) return within(style.error(), "--style");
    for (auto& key : keys)
      if (key.style < 0) key.style = *style;
  }
  options.direction = Direction(std::move(keys));
  const auto sampler = parse_sampler(words.sampler);
  if (!sampler)
    return Error{Errc::usage, "--sampler '" + words.sampler + "'", "is not known",
                 "Known: dpm++, ddim, ddpm"};
  options.sampler.kind = *sampler;
  options.num_steps = words.steps;
  options.seed = words.seed;
  return options;
}

}  // namespace mien
