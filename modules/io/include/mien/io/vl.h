#pragma once
#include <span>
#include <vector>

#include "mien/base/bytes.h"
#include "mien/base/result.h"
#include "mien/core/vector.h"

namespace mien {

/// A frame of the BIWI 3D audiovisual corpus (.vl): a little-endian uint32 number of vertices, then x, y, z
/// of each as float32 (FaceXHuBERT specification, section 4). Errors (Errc::input): a number that does not
/// fit the bytes, positions that are not finite.
Result<std::vector<Vec3>> read_vl(std::span<const std::byte> bytes);

/// The bytes of such a frame. @pre fewer than 2^32 vertices
Bytes write_vl(std::span<const Vec3> positions);

}  // namespace mien
