#pragma once
#include <cstdint>
#include <span>

#include "mien/base/bytes.h"

namespace mien {

/// The checksum of zip and PNG files.
std::uint32_t crc32(std::span<const std::byte> bytes);

}  // namespace mien
