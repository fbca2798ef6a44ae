#pragma once
#include <zlib.h>

#include <optional>
#include <string>
#include <vector>

#include "mien/base/bytes.h"

namespace mien::test {

struct ZipPart {
  std::string name;
  std::string content;
  bool deflated = false;
  std::optional<std::uint32_t> claimed_size{};  ///< a lie about the unpacked size
  std::optional<std::size_t> local_of{};        ///< points to the data of another part
};

/// A zip archive written by hand, with zlib's own compression and checksum.
inline Bytes make_zip(const std::vector<ZipPart>& parts) {
  Bytes out, directory;
  const auto text = [](Bytes& bytes, std::string_view t) {
    const auto raw = as_bytes(t);
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  };
  std::vector<std::uint32_t> offsets;
  std::vector<std::string> stored;
  for (const auto& part : parts) {
    std::string data = part.content;
    if (part.deflated) {
      data.resize(::compressBound(part.content.size()));
      z_stream stream{};
      ::deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(part.content.data()));
      stream.avail_in = static_cast<uInt>(part.content.size());
      stream.next_out = reinterpret_cast<Bytef*>(data.data());
      stream.avail_out = static_cast<uInt>(data.size());
      ::deflate(&stream, Z_FINISH);
      data.resize(stream.total_out);
      ::deflateEnd(&stream);
    }
    const auto crc = static_cast<std::uint32_t>(::crc32(
        0, reinterpret_cast<const Bytef*>(part.content.data()), static_cast<uInt>(part.content.size())));
    const auto size = part.claimed_size.value_or(static_cast<std::uint32_t>(part.content.size()));
    const auto header = [&](Bytes& bytes) {  // what the local header and the directory have in common
      append_le<std::uint16_t>(bytes, 20);
      append_le<std::uint16_t>(bytes, 0);
      append_le<std::uint16_t>(bytes, part.deflated ? 8 : 0);
      append_le<std::uint32_t>(bytes, 0);
      append_le<std::uint32_t>(bytes, crc);
      append_le<std::uint32_t>(bytes, static_cast<std::uint32_t>(data.size()));
      append_le<std::uint32_t>(bytes, size);
      append_le<std::uint16_t>(bytes, static_cast<std::uint16_t>(part.name.size()));
      append_le<std::uint16_t>(bytes, 0);
    };
    offsets.push_back(part.local_of ? offsets[*part.local_of] : static_cast<std::uint32_t>(out.size()));
    append_le<std::uint32_t>(directory, 0x02014b50);
    append_le<std::uint16_t>(directory, 20);
    header(directory);
    append_le<std::uint16_t>(directory, 0);
    append_le<std::uint16_t>(directory, 0);
    append_le<std::uint16_t>(directory, 0);
    append_le<std::uint32_t>(directory, 0);
    append_le<std::uint32_t>(directory, offsets.back());
    text(directory, part.name);
    if (part.local_of) continue;
    append_le<std::uint32_t>(out, 0x04034b50);
    header(out);
    text(out, part.name);
    text(out, data);
  }
  const auto at = static_cast<std::uint32_t>(out.size());
  out.insert(out.end(), directory.begin(), directory.end());
  append_le<std::uint32_t>(out, 0x06054b50);
  append_le<std::uint32_t>(out, 0);
  append_le<std::uint16_t>(out, static_cast<std::uint16_t>(parts.size()));
  append_le<std::uint16_t>(out, static_cast<std::uint16_t>(parts.size()));
  append_le<std::uint32_t>(out, static_cast<std::uint32_t>(directory.size()));
  append_le<std::uint32_t>(out, at);
  append_le<std::uint16_t>(out, 0);
  return out;
}

}  // namespace mien::test
