#include "gltf_builder.h"

#include <algorithm>

#include "glb_container.h"

namespace mien::io {

std::size_t GltfBuilder::add_view(std::span<const std::byte> bytes, Target target) {
  bin_.resize((bin_.size() + 3) / 4 * 4);
  Json view = {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", bytes.size()}};
  if (target != kNone) view["target"] = static_cast<int>(target);
  bin_.insert(bin_.end(), bytes.begin(), bytes.end());
  json["bufferViews"].push_back(std::move(view));
  return json["bufferViews"].size() - 1;
}

std::size_t GltfBuilder::add_accessor(Json accessor) {
  json["accessors"].push_back(std::move(accessor));
  return json["accessors"].size() - 1;
}

Result<Bytes> GltfBuilder::finish() {
  json["buffers"] = Json::array({{{"byteLength", bin_.size()}}});
  MIEN_TRY(GlbDraft draft, assemble_glb(json_text(json), bin_.size()));
  std::copy(bin_.begin(), bin_.end(), draft.bytes.begin() + static_cast<std::ptrdiff_t>(draft.bin_start));
  return std::move(draft.bytes);
}

}  // namespace mien::io
