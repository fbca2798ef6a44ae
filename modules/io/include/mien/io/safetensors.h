#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/bytes.h"
#include "mien/base/result.h"

// safetensors: 8 bytes little-endian header length n, n bytes of JSON {name: {dtype, shape, data_offsets}},
// then the data of all tensors, little-endian, row-major, up to the end of the file. At most 100 MB of
// header.
namespace mien {

/// Element type of a stored tensor. f16 is IEEE binary16, bf16 the upper half of a binary32.
enum class Dtype { f64, f32, f16, bf16, i64, i32, i16, i8, u8, boolean };

/// Name in the file format: "F32", "BF16", "BOOL" ...
std::string_view dtype_name(Dtype dtype);
/// Bytes per element.
std::size_t dtype_size(Dtype dtype);

/// True when a tensor of `dtype` may be viewed as (or written from) elements of type T. 16-bit floats are
/// viewed as std::uint16_t; BOOL as std::uint8_t.
template <class T>
bool dtype_holds(Dtype dtype);

struct StoredTensor {
  std::string name;
  Dtype dtype = Dtype::f32;
  std::vector<std::int64_t> shape;           ///< empty for a scalar; a 0 makes the tensor empty
  [[nodiscard]] std::int64_t count() const;  ///< product of the shape
};

using Metadata = std::map<std::string, std::string>;

/// A safetensors file, mapped into memory and checked completely before use. Immutable; may be shared by
/// threads. Spans stay valid as long as the object (or what it was moved to) lives.
class SafetensorsFile {
 public:
  /// Errors (Errc::input): unreadable file, or any breach of the format, each named: header length beyond the
  /// file, bad JSON or UTF-8, repeated name, unknown dtype, size overflow, overlap, gap, bytes missing or
  /// left over.
  static Result<SafetensorsFile> open(const std::filesystem::path& path);
  /// The same from memory; `name` stands for the file in messages.
  static Result<SafetensorsFile> parse(Bytes bytes, std::string_view name = "safetensors data");
  SafetensorsFile(SafetensorsFile&&) noexcept;
  SafetensorsFile& operator=(SafetensorsFile&&) noexcept;
  ~SafetensorsFile();

  [[nodiscard]] const Metadata& metadata() const;
  /// In the order of their data.
  [[nodiscard]] const std::vector<StoredTensor>& tensors() const;
  /// nullptr when there is no such tensor.
  [[nodiscard]] const StoredTensor* find(std::string_view name) const;
  /// Error (Errc::incompatible) naming file and tensor when it is absent or its shape differs. -1 matches any
  /// size.
  Result<const StoredTensor*> expect(std::string_view name, std::span<const std::int64_t> shape) const;

  /// The stored bytes, at an address aligned for the tensor's dtype. Error (Errc::incompatible): absent.
  Result<std::span<const std::byte>> raw(std::string_view name) const;
  /// Elements in place. Errors (Errc::incompatible): absent, or another dtype. T: float, double,
  /// std::uint8_t, std::int8_t, std::int16_t, std::int32_t, std::int64_t, std::uint16_t (bits of F16 or
  /// BF16).
  template <class T>
  Result<std::span<const T>> as(std::string_view name) const {
    MIEN_TRY(const auto bytes, typed(name, &dtype_holds<T>, sizeof(T)));
    return std::span<const T>(reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T));
  }
  /// A copy as float32, converted from F64 (rounded), F32, F16 or BF16. Errors (Errc::incompatible): absent,
  /// not a floating-point dtype. NaN and infinity pass; see first_non_finite().
  Result<std::vector<float>> read_float(std::string_view name) const;
  /// Index of the first NaN or infinity of a floating-point tensor, if any: for the loader of a model that
  /// must not run on broken weights. Errors as read_float().
  Result<std::optional<std::int64_t>> first_non_finite(std::string_view name) const;

 private:
  struct State;
  explicit SafetensorsFile(std::unique_ptr<State> state);
  static Result<SafetensorsFile> check(std::unique_ptr<State> state);
  Result<std::span<const std::byte>> typed(std::string_view name, bool (*holds)(Dtype),
                                           std::size_t size) const;
  std::unique_ptr<State> state_;
};

/// Writes a safetensors file of any size in constant memory: all tensors are declared first, then filled in
/// any order and in blocks. The file appears under its name when finish() succeeds. Equal declarations and
/// data give equal bytes: metadata is sorted by key; data is ordered by falling element size, then as
/// declared, so every tensor is aligned.
class SafetensorsWriter {
 public:
  /// Errors (Errc::failed): the file cannot be written; metadata that is not UTF-8. @pre names are unique,
  /// not empty, not "__metadata__"; no negative size.
  static Result<SafetensorsWriter> create(const std::filesystem::path& path,
                                          std::vector<StoredTensor> tensors, const Metadata& metadata = {});
  SafetensorsWriter(SafetensorsWriter&&) noexcept;
  SafetensorsWriter& operator=(SafetensorsWriter&&) noexcept;
  ~SafetensorsWriter();

  /// Appends the next elements of a tensor. Errors (Errc::failed): e.g. the disk is full. @pre declared, T
  /// fits its dtype, and there is room left.
  template <class T>
  Status write(std::string_view name, std::span<const T> elements) {
    return write_elements(name, &dtype_holds<T>, std::as_bytes(elements));
  }
  template <class T>
  Status write(std::string_view name, const std::vector<T>& elements) {
    return write(name, std::span<const T>(elements));
  }
  /// Fills elements from `first` on. Each element must be written exactly once; only their number is checked.
  template <class T>
  Status write_at(std::string_view name, std::int64_t first, std::span<const T> elements) {
    return write_elements_at(name, first, &dtype_holds<T>, std::as_bytes(elements));
  }
  /// float32 in, converted to the tensor's F64, F32, F16 or BF16 (round to nearest even).
  Status write_float(std::string_view name, std::span<const float> values);
  Status write_float_at(std::string_view name, std::int64_t first, std::span<const float> values);

  /// Gives the file its name. Error (Errc::failed): the disk. @pre every element was written.
  Status finish();

 private:
  struct State;
  explicit SafetensorsWriter(std::unique_ptr<State> state);
  Status write_elements(std::string_view name, bool (*holds)(Dtype), std::span<const std::byte> bytes);
  Status write_elements_at(std::string_view name, std::int64_t first, bool (*holds)(Dtype),
                           std::span<const std::byte> bytes);
  std::unique_ptr<State> state_;
};

}  // namespace mien
