#include "mien/train/encoder_training.h"

#include <algorithm>

#include "batch_tensors.h"
#include "mien/models/model_file.h"
#include "mien/train/encoder_randomness.h"
#include "mien/train/torch_parameters.h"

namespace mien::train {
namespace {

// Whether the parameters whose names begin so are all frozen; "": all of the encoder's.
bool is_frozen(SpeechEncoder<torch::Tensor>& encoder, std::string_view beginning) {
  const auto entries = parameters(encoder);
  return std::none_of(entries.begin(), entries.end(), [&](const Collect::Entry& e) {
    return e.name.starts_with(beginning) && e.slot->requires_grad();
  });
}

}  // namespace

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

ClipEncoder::ClipEncoder(SpeechEncoder<torch::Tensor>& encoder, const EncoderNoise& noise,
                         torch::Device device, bool keeps)
    : encoder_(encoder), noise_(noise), device_(device), keeps_(Keeps::nothing) {
  const bool is_random = noise.dropout || noise.layer_drop || noise.spec_augment;
  if (keeps && is_frozen(encoder, "feature_"))
    keeps_ = !is_random && is_frozen(encoder, "") ? Keeps::all : Keeps::front;
}

torch::Tensor ClipEncoder::projected(const std::vector<float>& waveform) const {
  const auto length = static_cast<std::int64_t>(waveform.size());
  return encoder_.project(encoder_.extract(as_tensor(waveform, {1, length, 1}).to(device_)));
}

torch::Tensor ClipEncoder::operator()(const std::string& name, const std::vector<float>& waveform,
                                      Rng* random) {
  torch::Tensor front;
  if (keeps_ == Keeps::nothing) {
    front = projected(waveform);
  } else {
    torch::Tensor& kept = kept_[name];
    if (!kept.defined()) {
      const torch::NoGradGuard no_grad;
      kept = projected(waveform);
      if (keeps_ == Keeps::all) kept = encoder_.transform(kept);
    }
    if (keeps_ == Keeps::all) return kept;
    front = kept;
  }
  return random == nullptr ? encoder_.transform(front)
                           : transform_at_random(encoder_, front, {}, noise_, *random);
}

}  // namespace mien::train
