#pragma once
#include <bit>
#include <cstdint>
#include <span>

#include "mien/base/bytes.h"
#include "mien/io/safetensors.h"

namespace mien {

inline float bfloat_to_float(std::uint16_t bits) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(bits) << 16);
}

inline bool is_floating(Dtype dtype) {
  return dtype == Dtype::f64 || dtype == Dtype::f32 || dtype == Dtype::f16 || dtype == Dtype::bf16;
}

/// Calls use(i, value) for every element of floating-point data at any address; F64 is narrowed to float
/// first.
template <class Use>
void for_each_float(Dtype dtype, std::span<const std::byte> bytes, Use&& use) {
  const std::size_t size = dtype_size(dtype);
  for (std::size_t i = 0; i < bytes.size() / size; ++i) {
    switch (dtype) {
      case Dtype::f64:
        use(i, static_cast<float>(*read_le<double>(bytes, i * 8)));
        break;
      case Dtype::f32:
        use(i, *read_le<float>(bytes, i * 4));
        break;
      case Dtype::f16:
        use(i, half_to_float(*read_le<std::uint16_t>(bytes, i * 2)));
        break;
      default:
        use(i, bfloat_to_float(*read_le<std::uint16_t>(bytes, i * 2)));
        break;
    }
  }
}

}  // namespace mien
