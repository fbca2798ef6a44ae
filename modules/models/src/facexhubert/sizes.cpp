#include <string>

#include "mien/models/facexhubert/network.h"

namespace mien::facexhubert {

Result<Sizes> sizes_of(const SafetensorsFile& file) {
  const auto columns = [&](const char* name) -> std::int64_t {
    const StoredTensor* stored = file.find(name);
    return stored != nullptr && stored->shape.size() == 2 ? stored->shape[1] : 0;
  };
  const StoredTensor* out = file.find("fc.weight");
  Sizes s;
  s.input = columns("gru.weight_ih_l0");
  s.hidden = columns("gru.weight_hh_l0");
  s.num_layers = 0;
  while (file.find("gru.weight_ih_l" + std::to_string(s.num_layers)) != nullptr) ++s.num_layers;
  s.num_subjects = columns("obj_vector.weight");
  s.num_emotions = columns("emo_vector.weight");
  s.num_channels = out != nullptr && out->shape.size() == 2 ? out->shape[0] : 0;
  if (s.input <= 0 || s.hidden <= 0 || s.num_layers <= 0 || s.num_subjects <= 0 || s.num_emotions <= 0 ||
      s.num_channels <= 0)
    return Error{Errc::incompatible, "weights", "are not those of FaceXHuBERT",
                 "Expected are gru, fc, obj_vector and emo_vector"};
  return s;
}

}  // namespace mien::facexhubert
