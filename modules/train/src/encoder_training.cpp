#include "mien/train/encoder_training.h"

#include "mien/models/model_file.h"
#include "mien/train/encoder_randomness.h"
#include "mien/train/torch_parameters.h"

namespace mien::train {

Status load_encoder(SpeechEncoder<torch::Tensor>& encoder, const SafetensorsFile& file) {
  Collect list;
  list.scope("audio_encoder", encoder);
  std::erase_if(list.entries, [&](const Collect::Entry& e) {
    return e.name.ends_with("masked_spec_embed") && file.find(e.name) == nullptr;
  });
  return load_parameters(list.entries, file, ModelFile::kEncoderPrefix);
}

torch::Tensor transform_at_random(const SpeechEncoder<torch::Tensor>& encoder, const torch::Tensor& projected,
                                  EncoderCall call, const EncoderNoise& noise, Rng& random) {
  const EncoderConfig& config = encoder.config;
  std::vector<std::uint8_t> masked, skipped;
  if (noise.spec_augment)
    for (std::int64_t i = 0; i < projected.size(0); ++i) {
      const auto own = draw_masked_frames(config, projected.size(1), random);
      masked.insert(masked.end(), own.begin(), own.end());
    }
  if (noise.layer_drop) skipped = draw_skipped_layers(config, random);
  call.masked_frames = masked;
  call.skipped_layers = skipped;
  return noise.dropout ? encoder.transform(projected, call, DropoutHooks{config})
                       : encoder.transform(projected, call);
}

}  // namespace mien::train
