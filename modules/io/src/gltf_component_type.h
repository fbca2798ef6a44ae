#pragma once
#include <cstdint>

namespace mien::io {

/// glTF 2.0, section 3.6.2.2: what an accessor's componentType says of its numbers.
enum GltfComponentType : std::uint32_t {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126
};

}  // namespace mien::io
