#include <zlib.h>

#include <algorithm>
#include <limits>

#include "inflate.h"

namespace mien {

Result<Bytes> inflate(std::span<const std::byte> packed, std::size_t size) {
  z_stream stream{};
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK)
    return Error{Errc::failed, "", "cannot be unpacked: zlib does not start", ""};
  Bytes out(std::max<std::size_t>(size, 1));                        // zlib wants an address even for nothing
  constexpr std::size_t kPiece = std::numeric_limits<uInt>::max();  // zlib counts in 32 bits
  std::size_t read = 0, written = 0;
  int state = Z_OK;
  while (state == Z_OK) {
    const std::size_t input = std::min(packed.size() - read, kPiece), room = std::min(size - written, kPiece);
    stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(packed.data() + read));
    stream.avail_in = static_cast<uInt>(input);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + written);
    stream.avail_out = static_cast<uInt>(room);
    state = ::inflate(&stream, Z_NO_FLUSH);
    const std::size_t used = input - stream.avail_in, made = room - stream.avail_out;
    read += used, written += made;
    if (state == Z_OK && used == 0 && made == 0) state = Z_BUF_ERROR;
  }
  ::inflateEnd(&stream);
  if (state != Z_STREAM_END || written != size)
    return Error{Errc::input, "", "does not unpack to the " + std::to_string(size) + " bytes that it should",
                 ""};
  out.resize(size);
  return out;
}

}  // namespace mien
