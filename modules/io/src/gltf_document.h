#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "json_access.h"
#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien::io {

/// A parsed glTF 2.0 file with its buffers in reach. Holds views into the bytes it was parsed from.
struct GltfDocument {
  Json json;
  std::span<const std::byte> bin;  ///< BIN chunk, empty for text files
  bool has_bin = false;            ///< buffer 0 is the BIN chunk
  std::vector<Bytes> decoded;      ///< data of buffers with a URI
  std::vector<std::span<const std::byte>>
      buffers;  ///< one per entry of json["buffers"]; empty when out of reach
};

/// Parses a .glb or a .gltf text. Buffers may be the BIN chunk, data URIs or, when `folder` is given, files
/// in it or below it; `with_buffers` = false leaves the buffers alone. Errors (Errc::input): not glTF 2, a
/// buffer shorter than it says.
Result<GltfDocument> parse_gltf(std::span<const std::byte> bytes,
                                const std::filesystem::path* folder = nullptr, bool with_buffers = true);

/// Bytes of a buffer view. Errors: no such view, outside its buffer, compressed by an extension.
Result<std::span<const std::byte>> view_bytes(const GltfDocument& document, std::size_t view);

}  // namespace mien::io
