#include "encoder_weights.h"

#include <algorithm>
#include <array>
#include <set>

#include "mien/base/file.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/nn/runtime_operations.h"
#include "parameter_list.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kAnchor = "feature_extractor.conv_layers.0.conv.weight";
constexpr std::string_view kFairseqAnchor = "feature_extractor.conv_layers.0.0.weight";
constexpr std::string_view kPositions = "encoder.pos_conv_embed.conv.";

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  if (const auto at = text.find(from); at != text.npos) text.replace(at, from.size(), to);
  return text;
}

// fairseq's name of a tensor (without prefix) under the Hugging Face library's; unknown names stay.
std::string from_fairseq(std::string name) {
  if (name == "mask_emb") return "masked_spec_embed";
  if (name.starts_with("layer_norm.")) return "feature_projection." + name;
  if (name.starts_with("post_extract_proj."))
    return replaced(name, "post_extract_proj", "feature_projection.projection");
  if (name.starts_with("encoder.pos_conv.0.")) return replaced(name, "pos_conv.0", "pos_conv_embed.conv");
  if (name.starts_with("feature_extractor.conv_layers.")) {
    const auto index_end = name.find('.', 30);
    if (index_end == name.npos) return name;
    const std::string layer = name.substr(0, index_end), part = name.substr(index_end);
    if (part.starts_with(".0.")) return layer + ".conv" + part.substr(2);
    if (part.starts_with(".2.1.")) return layer + ".layer_norm" + part.substr(4);
    if (part.starts_with(".2.")) return layer + ".layer_norm" + part.substr(2);
    return name;
  }
  if (!name.starts_with("encoder.layers.")) return name;
  if (name.find(".self_attn_layer_norm.") != name.npos)
    return replaced(name, ".self_attn_layer_norm.", ".layer_norm.");
  name = replaced(name, ".self_attn.", ".attention.");
  name = replaced(name, ".fc1.", ".feed_forward.intermediate_dense.");
  return replaced(name, ".fc2.", ".feed_forward.output_dense.");
}

}  // namespace

std::map<std::string, Shape> FoundEncoder::shapes() const {
  std::map<std::string, Shape> all;
  for (const auto& tensor : tensors) all.emplace(tensor.name, tensor.shape);
  return all;
}

Result<std::optional<FoundEncoder>> find_encoder(const WeightsSource& weights, const std::string& file) {
  FoundEncoder found;
  bool is_fairseq = false;
  std::string anchor;
  for (const auto& tensor : weights.tensors())
    for (const auto ending : {kAnchor, kFairseqAnchor}) {
      if (!tensor.name.ends_with(ending)) continue;
      if (!anchor.empty())
        return Error{Errc::incompatible, file,
                     "holds two speech encoders: '" + anchor + "' and '" + tensor.name + "'", ""};
      anchor = tensor.name;
      found.prefix = anchor.substr(0, anchor.size() - ending.size());
      is_fairseq = ending == kFairseqAnchor;
    }
  if (anchor.empty()) return std::optional<FoundEncoder>();
  for (const auto& tensor : weights.tensors()) {
    if (!tensor.name.starts_with(found.prefix)) continue;
    std::string name = tensor.name.substr(found.prefix.size());
    if (is_fairseq) name = from_fairseq(std::move(name));
    name = replaced(std::move(name), "conv.parametrizations.weight.original0", "conv.weight_g");
    name = replaced(std::move(name), "conv.parametrizations.weight.original1", "conv.weight_v");
    if (name == std::string(kPositions) + "weight" && tensor.shape.size() == 3) {
      // Weight norm was removed: the weight itself is the direction, its own tap lengths are the lengths.
      found.tensors.push_back({std::string(kPositions) + "weight_v", tensor.shape, tensor.name});
      found.tensors.push_back({std::string(kPositions) + "weight_g",
                               {1, 1, tensor.shape[2]},
                               tensor.name,
                               ImportedTensor::How::tap_lengths});
      continue;
    }
    found.tensors.push_back({std::move(name), tensor.shape, tensor.name});
  }
  return std::optional(std::move(found));
}

Result<std::vector<ImportedTensor>> encoder_tensors(const FoundEncoder& found, const EncoderConfig& config,
                                                    const std::string& file) {
  SpeechEncoder<Tensor> network(config);
  ListParameters list;
  network.visit(list);
  return matching_tensors(list.entries, found.tensors, found.prefix, file);
}

Result<std::optional<EncoderConfig>> read_encoder_config(const fs::path& path) {
  std::error_code ec;
  const bool is_folder = fs::is_directory(path, ec);
  const fs::path file = is_folder ? path / "config.json" : path;
  if (is_folder && !fs::exists(file, ec)) return std::optional<EncoderConfig>();
  MIEN_TRY(const auto text, read_file(file));
  auto config = encoder_config_from_json(as_text(text));
  if (!config) return within(config.error(), "'" + file.string() + "'");
  const fs::path processor = file.parent_path() / "preprocessor_config.json";
  if (fs::exists(processor, ec)) {
    MIEN_TRY(const auto processor_text, read_file(processor));
    if (const auto read = read_preprocessor_config(as_text(processor_text), *config); !read)
      return within(read.error(), "'" + processor.string() + "'");
  }
  return std::optional(std::move(*config));
}

}  // namespace mien
