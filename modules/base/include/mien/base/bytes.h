#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mien {

using Bytes = std::vector<std::byte>;

/// Little-endian value at `offset`, or nothing when it would read past the end. T is an arithmetic type.
template <class T>
std::optional<T> read_le(std::span<const std::byte> bytes, std::size_t offset) {
  static_assert(std::endian::native == std::endian::little, "big-endian hosts are not supported");
  if (offset > bytes.size() || bytes.size() - offset < sizeof(T)) return std::nullopt;
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

/// Appends the little-endian bytes of `value`.
template <class T>
void append_le(Bytes& bytes, T value) {
  static_assert(std::endian::native == std::endian::little, "big-endian hosts are not supported");
  const auto* p = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), p, p + sizeof(T));
}

inline std::span<const std::byte> as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}
inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// a * b, or nothing when it does not fit: for sizes that come from a file.
std::optional<std::size_t> checked_multiply(std::size_t a, std::size_t b);

/// IEEE 754 binary16 <-> binary32, round to nearest even. Values above the half range become infinity.
std::uint16_t float_to_half(float value);
float half_to_float(std::uint16_t half);

}  // namespace mien
