#include <string>

#include "mien/models/facexhubert/network.h"
#include "mien/models/model_file.h"

namespace mien::facexhubert {

Result<Sizes> sizes_of(const SafetensorsFile& file) { return sizes_of(stored_shapes(file)); }

Result<Sizes> sizes_of(const std::map<std::string, Shape>& shapes) {
  const auto size = [&](const char* name, std::size_t axis) -> std::int64_t {
    const auto stored = shapes.find(name);
    return stored != shapes.end() && stored->second.size() == 2 ? stored->second[axis] : 0;
  };
  const auto columns = [&](const char* name) { return size(name, 1); };
  Sizes s;
  const auto decoder = stored_decoder(shapes);
  if (decoder) {
    s.input = decoder->input;
    s.hidden = decoder->hidden;
    s.decoder = decoder->sizes;
  }
  s.num_subjects = columns("obj_vector.weight");
  s.num_emotions = columns("emo_vector.weight");
  s.num_channels = size("fc.weight", 0);
  if (!decoder || s.input <= 0 || s.hidden <= 0 || s.num_subjects <= 0 || s.num_emotions <= 0 ||
      s.num_channels <= 0)
    return Error{Errc::incompatible, "weights", "are not those of FaceXHuBERT",
                 "Expected are gru (or rnn, lstm, transformer), fc, obj_vector and emo_vector"};
  return s;
}

}  // namespace mien::facexhubert
