#include "style_choice.h"

#include <algorithm>

#include "choose_name.h"
#include "mien/base/number_text.h"
#include "mien/models/probtalk3d/conventions.h"

namespace mien::probtalk3d {
namespace {

Result<std::int64_t> chosen_intensity(const std::string& word, const std::vector<std::string>& names,
                                      bool is_neutral) {
  const auto count = static_cast<std::int64_t>(names.size());
  if (const auto level = parse_int(word)) {
    if (*level >= 1 && *level <= count) return *level - 1;
    return Error{Errc::usage, "--emotion",
                 "has the level " + word + ", the model knows 1 to " + std::to_string(count), ""};
  }
  const std::size_t by_default = is_neutral ? 0 : std::min<std::size_t>(1, names.size() - 1);
  return choose_name("--emotion: the intensity", word, names, by_default);
}

}  // namespace

Result<std::vector<float>> chosen_style(const ModelFile& model, const FaceOptions& options) {
  MIEN_TRY(const auto identity, choose_name("--style", options.style, model.subjects, 0));
  const auto cut = options.emotion.find(':');
  const std::string emotion_name = options.emotion.substr(0, cut);
  MIEN_TRY(const auto emotion, choose_name("--emotion", emotion_name, model.emotions, 0));
  if (cut != std::string::npos && cut + 1 == options.emotion.size())
    return Error{Errc::usage, "--emotion '" + options.emotion + "'", "names no intensity behind the colon",
                 ""};
  const std::string word = cut == std::string::npos ? "" : options.emotion.substr(cut + 1);
  const bool is_neutral = model.emotions[static_cast<std::size_t>(emotion)] == "neutral";
  MIEN_TRY(const auto intensity, chosen_intensity(word, model.intensities, is_neutral));
  const auto count = [](const std::vector<std::string>& names) {
    return static_cast<std::int64_t>(names.size());
  };
  return style_weights(identity, count(model.subjects), emotion, count(model.emotions), intensity,
                       count(model.intensities));
}

}  // namespace mien::probtalk3d
