#pragma once
#include <span>
#include <string_view>

#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien::io {

/// The two chunks of a binary glTF file (glTF 2.0, section "GLB File Format"), as views into it.
struct GlbChunks {
  std::string_view json;
  std::span<const std::byte> bin;  ///< empty when the file has no BIN chunk
  bool has_bin = false;
};

bool is_glb(std::span<const std::byte> bytes);

/// Errors (Errc::input): wrong magic or version, lengths that do not fit the file. Unknown chunks are
/// skipped.
Result<GlbChunks> split_glb(std::span<const std::byte> bytes);

/// A .glb under construction: header, JSON chunk and a zeroed BIN chunk.
struct GlbDraft {
  Bytes bytes;
  std::size_t bin_start = 0;  ///< offset of the BIN data in `bytes`
};

/// Errors (Errc::failed): the file would be larger than the format's 4 GiB. No BIN chunk when bin_size is 0.
Result<GlbDraft> assemble_glb(std::string_view json, std::size_t bin_size);

}  // namespace mien::io
