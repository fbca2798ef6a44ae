#include "glb_container.h"

#include <limits>

namespace mien::io {
namespace {

constexpr std::uint32_t kMagic = 0x46546C67;  // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinChunk = 0x004E4942;
constexpr std::size_t kHeaderSize = 12;
constexpr std::size_t kChunkHeaderSize = 8;

Error broken(std::string why) {
  return {Errc::input, "glTF binary", std::move(why), "The file may be incomplete; export it again"};
}

std::size_t padded(std::size_t size) { return (size + 3) / 4 * 4; }

}  // namespace

bool is_glb(std::span<const std::byte> bytes) { return read_le<std::uint32_t>(bytes, 0) == kMagic; }

Result<GlbChunks> split_glb(std::span<const std::byte> bytes) {
  const auto version = read_le<std::uint32_t>(bytes, 4);
  const auto length = read_le<std::uint32_t>(bytes, 8);
  if (!is_glb(bytes) || !length) return broken("no glTF header");
  if (*version != 2) return broken("version " + std::to_string(*version) + ", expected 2");
  if (*length > bytes.size() || *length < kHeaderSize)
    return broken("the header says " + std::to_string(*length) + " bytes, the file has " +
                  std::to_string(bytes.size()));
  bytes = bytes.first(*length);

  GlbChunks chunks;
  bool has_json = false;
  for (std::size_t at = kHeaderSize; at < bytes.size();) {
    const auto size = read_le<std::uint32_t>(bytes, at);
    const auto type = read_le<std::uint32_t>(bytes, at + 4);
    if (!type || *size > bytes.size() - at - kChunkHeaderSize) return broken("a chunk ends outside the file");
    const auto data = bytes.subspan(at + kChunkHeaderSize, *size);
    if (!has_json) {
      if (*type != kJsonChunk) return broken("the first chunk is not JSON");
      chunks.json = as_text(data);
      has_json = true;
    } else if (*type == kBinChunk && !chunks.has_bin) {
      chunks.bin = data;
      chunks.has_bin = true;
    }
    at += kChunkHeaderSize + *size;
  }
  if (!has_json) return broken("there is no JSON chunk");
  return chunks;
}

Result<GlbDraft> assemble_glb(std::string_view json, std::size_t bin_size) {
  const std::size_t json_size = padded(json.size());
  const std::size_t bin_chunk = bin_size == 0 ? 0 : kChunkHeaderSize + padded(bin_size);
  const std::size_t total = kHeaderSize + kChunkHeaderSize + json_size + bin_chunk;
  if (total > std::numeric_limits<std::uint32_t>::max())
    return Error{Errc::failed, "glTF binary",
                 std::to_string(total >> 20) + " MiB are needed, the format ends at 4096 MiB",
                 "Animate a shorter recording or ask for quantised weights"};
  GlbDraft draft;
  draft.bytes.reserve(total);
  append_le(draft.bytes, kMagic);
  append_le(draft.bytes, std::uint32_t{2});
  append_le(draft.bytes, static_cast<std::uint32_t>(total));
  append_le(draft.bytes, static_cast<std::uint32_t>(json_size));
  append_le(draft.bytes, kJsonChunk);
  const auto text = as_bytes(json);
  draft.bytes.insert(draft.bytes.end(), text.begin(), text.end());
  draft.bytes.resize(kHeaderSize + kChunkHeaderSize + json_size, std::byte{' '});
  if (bin_size > 0) {
    append_le(draft.bytes, static_cast<std::uint32_t>(padded(bin_size)));
    append_le(draft.bytes, kBinChunk);
    draft.bin_start = draft.bytes.size();
    draft.bytes.resize(total);
  }
  return draft;
}

}  // namespace mien::io
