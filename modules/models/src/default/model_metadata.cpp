#include "mien/models/default/model_metadata.h"

#include "mien/models/model_file.h"

namespace mien::default_model {

double look_ahead_ms(const ModelMetadata& metadata) {
  constexpr double kInterpolation = 20.0 / 3, kHalfWindow = 12.5, kSmoother = 100.0 / 3;
  return 10.0 * static_cast<double>(metadata.look_ahead_mel_frames) + kInterpolation + kHalfWindow +
         kSmoother;
}

std::map<std::string, std::string> to_metadata(const ModelMetadata& m) {
  ModelFile file;
  file.name = m.name;
  file.input = "log-mel 64 at 100 Hz, running level";
  file.output = {.space = "arkit", .channels = 55, .fps = 60, .topology = ""};
  file.look_ahead_ms = look_ahead_ms(m);
  file.sizes = {{"width", m.sizes.width},
                {"condition", m.sizes.condition},
                {"diffusion_hidden", m.sizes.diffusion_hidden},
                {"blink_hidden", m.sizes.blink_hidden},
                {"brow_hidden", m.sizes.brow_hidden}};
  file.look_ahead_mel_frames = m.look_ahead_mel_frames;
  for (int s = 0; s < kStyleEntries - 1; ++s)
    file.styles.push_back((s < 10 ? "S0" : "S") + std::to_string(s));
  file.emotions = {"neutral", "happy", "sad", "surprised", "fear", "disgusted", "angry", "contempt"};
  file.licence = "Apache-2.0; trained on speech made by synthesisers, see docs/corpus.md";
  file.training_config = m.training_config;
  file.training_set = m.training_set;
  return mien::to_metadata(file);
}

Result<ModelMetadata> from_metadata(const std::map<std::string, std::string>& metadata) {
  MIEN_TRY(const ModelFile file, read_model_file(metadata));
  const auto broken = [](const std::string& why) {
    return Error{Errc::incompatible, "model description", why, "The file may be damaged"};
  };
  if (file.architecture != Architecture::default_model)
    return Error{Errc::incompatible, "model",
                 "has the architecture '" + std::string(architecture_name(file.architecture)) +
                     "', expected 'default'",
                 ""};
  ModelMetadata m;
  m.name = file.name;
  bool has_all_sizes = true;
  const auto size = [&](const char* key) -> std::int64_t {
    const auto found = file.sizes.find(key);
    const bool fits = found != file.sizes.end() && found->second >= 1 && found->second <= 4096;
    has_all_sizes = has_all_sizes && fits;
    return fits ? found->second : 0;
  };
  m.sizes = {size("width"), size("condition"), size("diffusion_hidden"), size("blink_hidden"),
             size("brow_hidden")};
  if (!has_all_sizes) return broken("a layer size is not within 1 ... 4096");
  if (!file.look_ahead_mel_frames || *file.look_ahead_mel_frames < 0 || *file.look_ahead_mel_frames > 100)
    return broken("the look-ahead is not within 0 ... 1 s");
  m.look_ahead_mel_frames = *file.look_ahead_mel_frames;
  m.training_config = file.training_config;
  m.training_set = file.training_set;
  return m;
}

}  // namespace mien::default_model
