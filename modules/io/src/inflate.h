#pragma once
#include <span>

#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien {

/// Raw deflate data that unpack to exactly `size` bytes. Errors (Errc::input): they do not; (Errc::failed):
/// this build has no zlib.
Result<Bytes> inflate(std::span<const std::byte> packed, std::size_t size);

}  // namespace mien
