#include "character_source.h"

#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "mien/face/pose.h"
#include "mien/io/character_file.h"
#include "mien/io/gltf_animation.h"
#include "mien/io/gltf_writer.h"
#include "share.h"

namespace mien {
namespace {

bool is_gltf(const Bytes& bytes) {
  const auto text = as_text(bytes).substr(0, 4096);
  const auto first = text.find_first_not_of(" \t\r\n");
  return text.starts_with("glTF") || (first != std::string_view::npos && text[first] == '{');
}

}  // namespace

Result<std::filesystem::path> character_path(const std::string& named) {
  if (!named.empty()) return std::filesystem::path(named);
  return shared_file("head.glb", "--character FILE");
}

Result<Bytes> character_glb(const std::filesystem::path& path) {
  const std::string name = "character '" + path.string() + "'";
  Bytes glb;
  if (path.extension() == ".safetensors") {
    MIEN_TRY(const Character character, load_character(path));
    MIEN_TRY(glb, write_glb(character, {.pivot = neck_pivot(character)}));
  } else {
    MIEN_TRY(glb, read_file(path));
    if (!is_gltf(glb))
      return Error{Errc::incompatible, name, "is not a glTF file",
                   "Use a .glb or .gltf with ARKit morph targets"};
  }
  Motion still{MotionSpace::arkit, arkit_and_head_channels(), 60, {}};
  still.values.assign(still.channels.size(), 0.0f);
  if (const auto tried = animate_glb(glb, still, ""); !tried) return within(tried.error(), name);
  return glb;
}

}  // namespace mien
