#pragma once
#include <torch/torch.h>

#include <map>
#include <string>
#include <vector>

#include "mien/base/random.h"
#include "mien/io/safetensors.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/train/torch_operations.h"

namespace mien::train {

/// Fills an encoder from a model file; masked_spec_embed keeps its start where the file has none. Errors
/// (Errc::incompatible): other sizes, missing and unknown tensors.
Status load_encoder(SpeechEncoder<torch::Tensor>& encoder, const SafetensorsFile& file);

/// What a training pass does inside the encoder: dropout where the configuration has it. Draws from
/// LibTorch's generator, which the caller seeds for every step.
struct DropoutHooks {
  const EncoderConfig& config;

  [[nodiscard]] torch::Tensor dropout(DropoutSite site, const torch::Tensor& x) const {
    return torch::dropout(x, probability(site), /*train=*/true);
  }
  [[nodiscard]] torch::Tensor attention(const torch::Tensor& q, const torch::Tensor& k,
                                        const torch::Tensor& v, std::int64_t heads,
                                        std::span<const std::int64_t> valid) const {
    using B = Operations<torch::Tensor>;
    const torch::Tensor weights = B::attention_weights(q, k, heads, valid);
    return B::attend(torch::dropout(weights, config.attention_dropout, /*train=*/true), v);
  }
  void stage(const char* /*name*/, std::int64_t /*index*/, const torch::Tensor& /*x*/) const {}

  [[nodiscard]] double probability(DropoutSite site) const {
    switch (site) {
      case DropoutSite::projection:
        return config.feat_proj_dropout;
      case DropoutSite::hidden:
        return config.hidden_dropout;
      case DropoutSite::activation:
        break;
    }
    return config.activation_dropout;
  }
};

/// What a training pass does at random inside an encoder, as far as its configuration has it.
struct EncoderNoise {
  bool dropout = true, layer_drop = true, spec_augment = true;
};

/// The encoder behind its projected features [B, T, D], as a training pass: masked spans of each sequence of
/// the batch and skipped layers are drawn from `random`, dropout from LibTorch's generator.
torch::Tensor transform_at_random(const SpeechEncoder<torch::Tensor>& encoder, const torch::Tensor& projected,
                                  EncoderCall call, const EncoderNoise& noise, Rng& random);

/// The encoder of a training whose steps hear one clip each.
class ClipEncoder {
 public:
  /// @param keeps  keep what the convolutions and the projection make of each clip where they are frozen:
  ///               nothing random comes before it, so the features are the same. [A, H] float32 for every
  ///               clip, 150 kB a second at H = 768. The whole encoder's output instead where all of it is
  ///               frozen and none of its randomness on. @pre freeze() was called; `encoder` outlives the
  ///               object
  ClipEncoder(SpeechEncoder<torch::Tensor>& encoder, const EncoderNoise& noise, torch::Device device,
              bool keeps);
  /// Features [1, A, H] of a clip [S], which is known by its name. Without `random` in evaluation mode.
  torch::Tensor operator()(const std::string& name, const std::vector<float>& waveform, Rng* random);
  [[nodiscard]] const EncoderConfig& config() const { return encoder_.config; }

 private:
  enum class Keeps { nothing, front, all };
  torch::Tensor projected(const std::vector<float>& waveform) const;

  SpeechEncoder<torch::Tensor>& encoder_;
  EncoderNoise noise_;
  torch::Device device_;
  Keeps keeps_;
  std::map<std::string, torch::Tensor> kept_;
};

}  // namespace mien::train
