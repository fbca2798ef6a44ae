// Writes the default head while Mien is built: mien-make-head OUT.glb OUT.json
// The .glb holds the character; the .json names its vertices: {mirror, handles, rings} of the part "skin".
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "mien/base/file.h"
#include "mien/base/parallel.h"
#include "mien/face/default_head.h"
#include "mien/face/pose.h"
#include "mien/io/gltf_writer.h"

namespace mien {
namespace {

std::string tables_text(const DefaultHead& head) {
  const nlohmann::json tables = {{"mirror", head.mirror}, {"handles", head.handles}, {"rings", head.rings}};
  return tables.dump() + "\n";
}

Status make_head(const std::string& glb_path, const std::string& tables_path) {
  const DefaultHead head = build_default_head(hardware_threads());
  GltfWriteOptions options;
  options.pivot = neck_pivot(head.character);
  MIEN_TRY(const auto glb, write_glb(head.character, options));
  MIEN_TRY([[maybe_unused]] const auto wrote_glb, write_file(glb_path, glb));
  return write_file(tables_path, tables_text(head));
}

}  // namespace
}  // namespace mien

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: mien-make-head OUT.glb OUT.json\n", stderr);
    return 2;
  }
  const auto made = mien::make_head(argv[1], argv[2]);
  if (made) return 0;
  std::fprintf(stderr, "mien-make-head: %s\n", made.error().message().c_str());
  return 1;
}
