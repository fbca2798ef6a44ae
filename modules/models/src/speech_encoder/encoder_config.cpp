#include "mien/models/speech_encoder/encoder_config.h"

#include <algorithm>

#include "refusal.h"

namespace mien {
namespace {

Status check_size(const char* field, std::int64_t value, std::int64_t largest) {
  if (value >= 1 && value <= largest) return Done{};
  return encoder_refusal(field,
                         "is " + std::to_string(value) + ", expected 1 ... " + std::to_string(largest));
}

Status check_probability(const char* field, double value) {
  if (value >= 0 && value < 1) return Done{};
  return encoder_refusal(field, "is " + std::to_string(value) + ", expected a probability below 1");
}

// Far above the largest member of the family (48 layers of 1280): what a file says is checked before it is
// allocated.
constexpr std::int64_t kMaxWidth = 16384, kMaxLayers = 256, kMaxKernel = 1024, kMaxConvLayers = 32;

Status check_convolutions(const EncoderConfig& c) {
  const std::size_t count = c.conv_dim.size();
  if (count == 0 || count > kMaxConvLayers)
    return encoder_refusal("conv_dim", "lists " + std::to_string(count) + " layers, expected 1 ... 32");
  if (c.conv_kernel.size() != count)
    return encoder_refusal("conv_kernel", "lists " + std::to_string(c.conv_kernel.size()) +
                                              " layers, conv_dim " + std::to_string(count));
  if (c.conv_stride.size() != count)
    return encoder_refusal("conv_stride", "lists " + std::to_string(c.conv_stride.size()) +
                                              " layers, conv_dim " + std::to_string(count));
  for (std::size_t i = 0; i < count; ++i) {
    MIEN_TRY([[maybe_unused]] const auto width, check_size("conv_dim", c.conv_dim[i], kMaxWidth));
    MIEN_TRY([[maybe_unused]] const auto kernel, check_size("conv_kernel", c.conv_kernel[i], kMaxKernel));
    MIEN_TRY([[maybe_unused]] const auto stride,
             check_size("conv_stride", c.conv_stride[i], c.conv_kernel[i]));
  }
  if (c.hop() > (1 << 20)) return encoder_refusal("conv_stride", "makes a frame longer than a minute");
  return Done{};
}

Result<const Shape*> shape_of(const std::map<std::string, Shape>& shapes, const std::string& name,
                              std::size_t rank) {
  const auto found = shapes.find(name);
  if (found == shapes.end())
    return Error{Errc::incompatible, "encoder", "tensor '" + name + "' is absent",
                 "Are these weights of a HuBERT?"};
  if (found->second.size() != rank)
    return Error{Errc::incompatible, "encoder",
                 "tensor '" + name + "' has " + std::to_string(found->second.size()) + " axes, expected " +
                     std::to_string(rank),
                 ""};
  return &found->second;
}

}  // namespace

std::int64_t EncoderConfig::receptive_field() const {
  std::int64_t samples = 1;
  for (std::size_t i = conv_kernel.size(); i-- > 0;)
    samples = (samples - 1) * conv_stride[i] + conv_kernel[i];
  return samples;
}

std::int64_t EncoderConfig::hop() const {
  std::int64_t hop = 1;
  for (const auto stride : conv_stride) hop = std::min<std::int64_t>(hop * stride, std::int64_t{1} << 40);
  return hop;
}

std::int64_t EncoderConfig::num_frames(std::int64_t num_samples) const {
  std::int64_t length = num_samples;
  for (std::size_t i = 0; i < conv_kernel.size(); ++i) {
    if (length < conv_kernel[i]) return 0;
    length = (length - conv_kernel[i]) / conv_stride[i] + 1;
  }
  return length;
}

Status EncoderConfig::validate() const {
  if (model_type != "hubert" && model_type != "wav2vec2")
    return encoder_refusal("model_type", "is '" + model_type + "', supported are hubert and wav2vec2");
  for (const auto& [field, value, largest] :
       {std::tuple{"hidden_size", hidden_size, kMaxWidth},
        std::tuple{"num_hidden_layers", num_hidden_layers, kMaxLayers},
        std::tuple{"num_attention_heads", num_attention_heads, kMaxWidth},
        std::tuple{"intermediate_size", intermediate_size, 4 * kMaxWidth},
        std::tuple{"num_conv_pos_embeddings", num_conv_pos_embeddings, kMaxKernel},
        std::tuple{"num_conv_pos_embedding_groups", num_conv_pos_embedding_groups, kMaxWidth}})
    if (auto checked = check_size(field, value, largest); !checked) return checked;
  if (hidden_size % num_attention_heads != 0)
    return encoder_refusal("num_attention_heads", std::to_string(num_attention_heads) +
                                                      " heads do not divide hidden_size " +
                                                      std::to_string(hidden_size));
  if (hidden_size % num_conv_pos_embedding_groups != 0)
    return encoder_refusal("num_conv_pos_embedding_groups", std::to_string(num_conv_pos_embedding_groups) +
                                                                " groups do not divide hidden_size " +
                                                                std::to_string(hidden_size));
  MIEN_TRY([[maybe_unused]] const auto convolutions, check_convolutions(*this));
  for (const auto& [field, value] : {std::pair{"mask_time_prob", mask_time_prob},
                                     {"mask_feature_prob", mask_feature_prob},
                                     {"hidden_dropout", hidden_dropout},
                                     {"activation_dropout", activation_dropout},
                                     {"attention_dropout", attention_dropout},
                                     {"feat_proj_dropout", feat_proj_dropout},
                                     {"layerdrop", layerdrop}})
    if (auto checked = check_probability(field, value); !checked) return checked;
  for (const auto& [field, value] :
       {std::pair{"mask_time_length", mask_time_length}, {"mask_feature_length", mask_feature_length}})
    if (auto checked = check_size(field, value, 1 << 20); !checked) return checked;
  for (const auto& [field, value] : {std::pair{"mask_time_min_masks", mask_time_min_masks},
                                     {"mask_feature_min_masks", mask_feature_min_masks}})
    if (value < 0 || value > (1 << 20)) return encoder_refusal(field, "is " + std::to_string(value));
  for (const auto& [field, value] :
       {std::pair{"layer_norm_eps", layer_norm_eps}, {"normalise_eps", normalise_eps}})
    if (!(value >= 0 && value <= 1))
      return encoder_refusal(field, "is " + std::to_string(value) + ", expected 0 ... 1");
  return Done{};
}

Result<EncoderConfig> encoder_config_from_shapes(const std::map<std::string, Shape>& shapes) {
  EncoderConfig c;
  const std::string convolution = "feature_extractor.conv_layers.";
  c.conv_dim.clear();
  c.conv_kernel.clear();
  for (std::size_t i = 0; shapes.contains(convolution + std::to_string(i) + ".conv.weight"); ++i) {
    MIEN_TRY(const Shape* const shape, shape_of(shapes, convolution + std::to_string(i) + ".conv.weight", 3));
    c.conv_dim.push_back((*shape)[0]);
    c.conv_kernel.push_back((*shape)[2]);
  }
  if (c.conv_kernel != EncoderConfig{}.conv_kernel)
    return encoder_refusal("conv_stride",
                           "cannot be told from the weights, whose kernels are not those of the base model");
  c.conv_bias = shapes.contains(convolution + "0.conv.bias");
  c.conv_layer_norm = shapes.contains(convolution + "1.layer_norm.weight");
  c.do_stable_layer_norm = c.conv_layer_norm;
  c.feat_proj_layer_norm = shapes.contains("feature_projection.layer_norm.weight");
  MIEN_TRY(const Shape* const projection, shape_of(shapes, "feature_projection.projection.weight", 2));
  c.hidden_size = (*projection)[0];
  c.num_hidden_layers = 0;
  while (shapes.contains("encoder.layers." + std::to_string(c.num_hidden_layers) + ".layer_norm.weight"))
    ++c.num_hidden_layers;
  MIEN_TRY(const Shape* const feed,
           shape_of(shapes, "encoder.layers.0.feed_forward.intermediate_dense.weight", 2));
  c.intermediate_size = (*feed)[0];
  MIEN_TRY(const Shape* const position, shape_of(shapes, "encoder.pos_conv_embed.conv.weight_v", 3));
  c.num_conv_pos_embeddings = (*position)[2];
  if ((*position)[1] < 1)
    return encoder_refusal("num_conv_pos_embedding_groups", "cannot be told from an empty tensor");
  c.num_conv_pos_embedding_groups = c.hidden_size / (*position)[1];
  if (c.hidden_size == 768)
    c.num_attention_heads = 12;
  else if (c.hidden_size == 1024 || c.hidden_size == 1280)
    c.num_attention_heads = 16;
  else
    return Error{Errc::incompatible, "encoder configuration: num_attention_heads",
                 "cannot be told from the weights: hidden_size " + std::to_string(c.hidden_size) +
                     " is not 768, 1024 or 1280",
                 "Put config.json beside the weights"};
  MIEN_TRY([[maybe_unused]] const auto valid, c.validate());
  return c;
}

}  // namespace mien
