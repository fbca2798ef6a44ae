#include "mien/models/model_file.h"
#include "mien/models/said/network.h"

namespace mien::said {
namespace {

constexpr const char* kFirstBlock = "denoiser.model.input_blocks.1.1.transformer_blocks.0.";

}  // namespace

Result<Sizes> sizes_of(const SafetensorsFile& file) { return sizes_of(stored_shapes(file)); }

Result<Sizes> sizes_of(const std::map<std::string, Shape>& shapes) {
  // Axis `axis` of a stored tensor of a given rank; 0 when there is none such.
  const auto size_of = [&](const std::string& name, std::size_t rank, std::size_t axis) -> std::int64_t {
    const auto stored = shapes.find(name);
    return stored != shapes.end() && stored->second.size() == rank ? stored->second[axis] : 0;
  };
  Sizes s;
  s.width = size_of("denoiser.model.input_blocks.0.0.weight", 3, 0);
  s.num_channels = size_of("denoiser.model.input_blocks.0.0.weight", 3, 1);
  s.time = size_of("denoiser.model.time_embed.0.weight", 2, 0);
  s.context = size_of(std::string(kFirstBlock) + "attn2.to_k.weight", 2, 1);
  s.inner = size_of(std::string(kFirstBlock) + "ff.net.2.weight", 2, 1);
  s.has_projection = shapes.contains("audio_proj_layer.weight");
  s.speech = s.has_projection ? size_of("audio_proj_layer.weight", 2, 1) : s.context;
  if (s.num_channels <= 0 || s.time <= 0 || s.context <= 0 || s.inner <= 0 || s.speech <= 0)
    return Error{Errc::incompatible, "weights", "are not those of a denoiser of SAiD",
                 "Expected are tensors like 'denoiser.model.input_blocks.0.0.weight'"};
  if (s.width <= 0 || s.width % Sizes::kHeadWidth != 0 || s.width % Sizes::kGroups != 0)
    return Error{Errc::incompatible, "weights",
                 "have a denoiser of width " + std::to_string(s.width) + ", which is no multiple of 32",
                 "SAiD's attention has heads of 32 channels"};
  return s;
}

}  // namespace mien::said
