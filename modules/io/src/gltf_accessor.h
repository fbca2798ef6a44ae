#pragma once
#include <cstdint>
#include <vector>

#include "gltf_document.h"

namespace mien::io {

/// Elements of an accessor: `count` rows of `components` numbers.
struct AccessorInfo {
  std::size_t count = 0;
  int components = 0;
  std::uint32_t component_type =
      0;  ///< 5120 byte, 5121 ubyte, 5122 short, 5123 ushort, 5125 uint, 5126 float
};

/// Errors (Errc::input): no such accessor, unknown types.
Result<AccessorInfo> accessor_info(const GltfDocument& document, std::size_t accessor);

/// All numbers as floats, [count, components]: normalised integers scaled as glTF 2.0 section 3.6.2.2 says,
/// sparse rows put in, strides followed. An accessor without data (only zeros) is read when `expected_count`
/// confirms its size, so that a small file cannot ask for much memory. Errors (Errc::input): components or
/// count other than expected (0 = any), data outside the buffers, sparse indices out of order, NaN or
/// infinity.
Result<std::vector<float>> read_floats(const GltfDocument& document, std::size_t accessor, int components,
                                       std::size_t expected_count = 0);

/// All numbers of an unsigned integer accessor, [count, components].
Result<std::vector<std::uint32_t>> read_integers(const GltfDocument& document, std::size_t accessor,
                                                 int components, std::size_t expected_count = 0);

}  // namespace mien::io
