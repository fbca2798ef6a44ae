#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/base/bytes.h"
#include "mien/base/result.h"
#include "mien/io/pickle.h"

namespace mien {

/// A NumPy array of numbers, row-major.
struct NpyArray {
  std::vector<std::int64_t> shape;  ///< empty for a single number
  std::vector<float> values;
};

/// Header of an .npy file (format version 1.0) of this shape, padded so that the data, which follows as raw
/// little-endian floats of `item_size` bytes (4 or 8), starts at a multiple of 64. It is as long for any size
/// of the axis `growing`. @pre no negative size
Bytes npy_header(std::span<const std::int64_t> shape, std::size_t item_size = 4, std::size_t growing = 0);
/// Header and data. @pre as many values as the shape says
Bytes write_npy(const NpyArray& array);

/// What the header of an .npy file says.
struct NpyLayout {
  std::vector<std::int64_t> shape;
  std::size_t item_size = 4;    ///< 4: float32, 8: float64
  std::size_t data_offset = 0;  ///< of the first number
};
/// Reads the header and checks that the data fits it, without touching the data: for large files that are
/// mapped. Errors: those of read_npy().
Result<NpyLayout> read_npy_layout(std::span<const std::byte> bytes);

/// The elements of any numeric array as they lie in `bytes`, which must outlive the result: integers and
/// floats of all sizes, both byte orders, C or Fortran order. Errors: those of read_npy(), but only arrays of
/// no numbers are of another type.
Result<PickleArray> npy_elements(std::span<const std::byte> bytes);

/// Reads versions 1.0 to 3.0 with little-endian float32 or float64 data (rounded to float32) in C order.
/// Errors (Errc::input): damaged header, missing or left-over bytes; (Errc::incompatible): other types,
/// Fortran order.
Result<NpyArray> read_npy(std::span<const std::byte> bytes);

}  // namespace mien
