#include "mien/models/probtalk3d/conventions.h"

#include <algorithm>
#include <limits>

#include "mien/base/contract.h"

namespace mien::probtalk3d {

std::vector<std::string> published_emotions() {
  return {"neutral", "happy", "sad", "surprised", "fear", "disgusted", "angry", "contempt"};
}

std::vector<std::string> published_intensities() { return {"low", "medium", "high"}; }

std::vector<std::string> published_identities() {
  return {"M003", "M005", "M007", "M009", "M011", "M012", "M013", "M019", "M022", "M023", "M024",
          "M025", "M026", "M027", "M028", "M029", "M030", "M031", "W009", "W011", "W014", "W015",
          "W016", "W018", "W019", "W021", "W023", "W024", "W025", "W026", "W028", "W029"};
}

std::vector<float> style_weights(std::int64_t identity, std::int64_t num_identities, std::int64_t emotion,
                                 std::int64_t num_emotions, std::int64_t intensity,
                                 std::int64_t num_intensities) {
  contract(identity >= 0 && identity < num_identities && emotion >= 0 && emotion < num_emotions &&
               intensity >= 0 && intensity < num_intensities,
           "style_weights: there is no such column");
  std::vector<float> weights(static_cast<std::size_t>(num_identities + num_emotions + num_intensities), 0.0f);
  for (const std::int64_t column :
       {identity, num_identities + emotion, num_identities + num_emotions + intensity})
    weights[static_cast<std::size_t>(column)] = 1;
  return weights;
}

ModelScaler published_scaler(std::int64_t num_channels) {
  ModelScaler scaler;
  for (std::int64_t c = 0; c < num_channels; ++c) {
    const bool is_jaw = c >= num_channels - kNumJaw;
    scaler.scale.push_back(is_jaw ? 1.6666666666666667 : 0.16666666666666666);
    scaler.min.push_back(is_jaw ? 0.16666666666666669 : 0.5);
  }
  return scaler;
}

void stretch_waveform(std::span<float> samples) {
  if (samples.empty()) return;
  const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
  const float least = *low;
  float range = *high - least;
  if (range < 10 * std::numeric_limits<float>::epsilon()) range = 1;
  const float scale = 2.0f / range, offset = -1.0f - least * scale;
  for (float& x : samples) x = x * scale + offset;
}

}  // namespace mien::probtalk3d
