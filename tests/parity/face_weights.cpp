#include "face_weights.h"

#include <algorithm>

#include "closeness.h"

namespace mien::parity {

EncoderConfig recorded_encoder(const nlohmann::json& hubert) {
  EncoderConfig c;
  c.hidden_size = hubert.at("hidden").get<std::int64_t>();
  c.num_hidden_layers = hubert.at("layers").get<std::int64_t>();
  c.num_attention_heads = hubert.at("heads").get<std::int64_t>();
  c.intermediate_size = hubert.at("inter").get<std::int64_t>();
  c.conv_dim.assign(c.conv_dim.size(), hubert.at("conv").get<std::int64_t>());
  return c;
}

Tensor speech_features(const Fixture& recorded) {
  std::string last;
  for (int layer = 0; recorded.has(numbered("hub.layer", layer)); ++layer)
    last = numbered("hub.layer", layer);
  return recorded.tensor(last);
}

Tensor as_row(const Tensor& x) { return x.reshaped({1, x.count()}); }

Tensor waveform(const Fixture& inputs, const std::string& suffix) {
  Tensor wave = inputs.tensor("audio_raw" + suffix);
  normalise_waveform(wave.values(), EncoderConfig().normalise_eps);
  MIEN_EXPECT_CLOSE(wave, inputs.tensor("audio" + suffix), "stage");
  return wave.reshaped({wave.count(), 1});
}

RecordedNoise::RecordedNoise(const Fixture& fixture, const std::string& initial, const std::string& steps)
    : initial_(fixture.tensor(initial)) {
  if (!fixture.has(steps)) return;
  const std::int64_t count = fixture.file().find(steps)->shape.at(0);
  for (std::int64_t i = 0; i < count; ++i) steps_.push_back(fixture.slice(steps, i));
}

void RecordedNoise::start(std::int64_t frame, std::span<float> out) const {
  std::copy_n(initial_.row(frame).begin(), out.size(), out.begin());
}

void RecordedNoise::step(int step, std::int64_t frame, std::span<float> out) const {
  std::copy_n(steps_.at(static_cast<std::size_t>(step)).row(frame).begin(), out.size(), out.begin());
}

}  // namespace mien::parity
