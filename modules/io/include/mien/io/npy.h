#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien {

/// A NumPy array of numbers, row-major.
struct NpyArray {
  std::vector<std::int64_t> shape;  ///< empty for a single number
  std::vector<float> values;
};

/// Header of a float32 .npy file (format version 1.0) of this shape, padded so that the data, which follows
/// as raw little-endian floats, starts at a multiple of 64. @pre no negative size
Bytes npy_header(std::span<const std::int64_t> shape);
/// Header and data. @pre as many values as the shape says
Bytes write_npy(const NpyArray& array);

/// Reads versions 1.0 to 3.0 with little-endian float32 or float64 data (rounded to float32) in C order.
/// Errors (Errc::input): damaged header, missing or left-over bytes; (Errc::incompatible): other types,
/// Fortran order.
Result<NpyArray> read_npy(std::span<const std::byte> bytes);

}  // namespace mien
