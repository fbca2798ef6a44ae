#include "gltf_document.h"

#include "base64.h"
#include "glb_container.h"
#include "mien/base/file.h"

namespace mien::io {
namespace {

namespace fs = std::filesystem;

Error bad_buffer(std::size_t index, std::string why) {
  return {Errc::input, "glTF buffer " + std::to_string(index), std::move(why), ""};
}

// "%20" and the like in a relative reference; anything malformed stays as it is.
std::string percent_decoded(std::string_view uri) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
  };
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      out += static_cast<char>(digit(uri[i + 1]) * 16 + digit(uri[i + 2]));
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

// A character file must not be able to name files elsewhere on the disk.
bool stays_below(const fs::path& relative) {
  if (relative.empty() || relative.is_absolute()) return false;
  for (const auto& part : relative)
    if (part == "..") return false;
  return true;
}

Result<Bytes> load_uri(std::size_t index, const std::string& uri, const fs::path* folder) {
  if (uri.starts_with("data:")) {
    const auto comma = uri.find(',');
    if (comma == std::string::npos ||
        std::string_view(uri).substr(0, comma).find(";base64") == std::string::npos)
      return bad_buffer(index, "its data URI is not base64");
    auto bytes = base64_decode(std::string_view(uri).substr(comma + 1));
    if (!bytes) return bad_buffer(index, "its data URI is not valid base64");
    return std::move(*bytes);
  }
  const fs::path relative = percent_decoded(uri);
  if (folder == nullptr || !stays_below(relative))
    return bad_buffer(index, "its data is in another file, '" + uri + "'");
  auto bytes = read_file(*folder / relative);
  if (!bytes) return within(bytes.error(), "glTF buffer " + std::to_string(index));
  return bytes;
}

Status resolve_buffers(GltfDocument& document, const fs::path* folder) {
  const Json& buffers = array_member(document.json, "buffers");
  document.decoded.resize(buffers.size());
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const auto length = index_member(buffers[i], "byteLength");
    if (!length) return bad_buffer(i, "it has no byteLength");
    std::span<const std::byte> data;
    if (member(buffers[i], "uri").is_string()) {
      MIEN_TRY(document.decoded[i], load_uri(i, text_member(buffers[i], "uri"), folder));
      data = document.decoded[i];
    } else if (i == 0 && document.has_bin) {
      data = document.bin;
    } else {
      document.buffers.emplace_back();  // e.g. the fallback buffer of a compression extension: never read
      continue;
    }
    if (data.size() < *length)
      return bad_buffer(
          i, "it has " + std::to_string(data.size()) + " bytes, expected " + std::to_string(*length));
    document.buffers.push_back(data.first(*length));
  }
  return Done{};
}

}  // namespace

Result<GltfDocument> parse_gltf(std::span<const std::byte> bytes, const fs::path* folder, bool with_buffers) {
  GltfDocument document;
  std::string_view text = as_text(bytes);
  if (is_glb(bytes)) {
    MIEN_TRY(const GlbChunks chunks, split_glb(bytes));
    text = chunks.json;
    document.bin = chunks.bin;
    document.has_bin = chunks.has_bin;
  }
  MIEN_TRY(document.json, parse_json(text, "glTF"));
  if (!document.json.is_object() || !member(document.json, "asset").is_object())
    return Error{Errc::input, "glTF", "there is no asset entry: not a glTF file", ""};
  if (const auto version = text_member(document.json["asset"], "version"); !version.starts_with("2."))
    return Error{Errc::input, "glTF", "version '" + version + "', expected 2.0",
                 "Convert the file to glTF 2.0"};
  // The BIN chunk belongs to buffer 0 only when that buffer names no other source.
  const Json& buffers = array_member(document.json, "buffers");
  if (buffers.empty() || member(buffers[0], "uri").is_string()) document.has_bin = false;
  if (with_buffers) {
    MIEN_TRY([[maybe_unused]] const auto done, resolve_buffers(document, folder));
  }
  return document;
}

Result<std::span<const std::byte>> view_bytes(const GltfDocument& document, std::size_t view) {
  const std::string name = "glTF bufferView " + std::to_string(view);
  const Json& views = array_member(document.json, "bufferViews");
  if (view >= views.size()) return Error{Errc::input, name, "does not exist", ""};
  const Json& entry = views[view];
  for (const char* compression : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (member(member(entry, "extensions"), compression).is_object())
      return Error{Errc::incompatible, name, std::string("is compressed by ") + compression,
                   "Export the character without compression"};
  const auto buffer = index_member(entry, "buffer");
  const auto length = index_member(entry, "byteLength");
  const std::size_t offset = index_member(entry, "byteOffset").value_or(0);
  if (!buffer || *buffer >= document.buffers.size() || !length)
    return Error{Errc::input, name, "names no buffer or no length", ""};
  const auto data = document.buffers[*buffer];
  if (offset > data.size() || *length > data.size() - offset)
    return Error{Errc::input, name, "lies outside its buffer", ""};
  return data.subspan(offset, *length);
}

}  // namespace mien::io
