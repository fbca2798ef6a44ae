#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/bytes.h"
#include "mien/base/result.h"
#include "mien/io/safetensors.h"

// Python pickles (protocols 0 to 5) read as data. A pickle is a small program that may import and call
// anything; this reader runs none of it. It knows None, truth values, numbers, strings, lists, tuples, sets,
// dictionaries, NumPy arrays, scalars and types, and PyTorch tensors. Everything else has a name, by which it
// is refused or kept aside unread.
namespace mien {

enum class PickleKind : std::uint8_t {
  none,
  boolean,
  integer,
  big_integer,  ///< beyond 64 bits: only its bytes are kept, little-endian two's complement
  real,
  text,   ///< also the byte strings of Python 2, which did not tell the two apart
  bytes,  ///< bytes or bytearray
  list,
  tuple,
  set,
  dict,
  array,    ///< NumPy array
  dtype,    ///< NumPy element type
  storage,  ///< memory of PyTorch tensors, stored outside the pickle
  tensor,   ///< PyTorch tensor or parameter
  global,   ///< a class or function, by name
  object,   ///< instance of a class that Mien does not know, or the result of a call that was not made
};

/// A NumPy array: raw elements inside the pickle.
struct PickleArray {
  char kind = 'f';  ///< NumPy's letter: f float, i and u integers, b truth values; others hold no numbers
  std::size_t item_size = 0;
  bool big_endian = false;
  bool fortran = false;  ///< stored with the first index fastest
  std::vector<std::int64_t> shape;
  std::span<const std::byte> data;  ///< as many bytes as shape and item_size say

  [[nodiscard]] std::int64_t count() const;
  /// All elements in row-major order. Errors (Errc::incompatible): the elements are no numbers, or 128-bit
  /// floats.
  [[nodiscard]] Result<std::vector<double>> to_doubles() const;
  /// The same, rounded to float32.
  [[nodiscard]] Result<std::vector<float>> to_floats() const;
};

/// Memory that tensors share, by its key.
struct PickleStorage {
  std::string_view key;
  std::optional<Dtype> dtype;  ///< nothing for memory without a type (torch.UntypedStorage), counted in bytes
  std::int64_t count = 0;      ///< elements
  std::int64_t view_offset = 0;  ///< first element, for the storage views of old files
};

/// A PyTorch tensor: a view of a storage. Offset and strides count elements; they were checked to be >= 0,
/// but not to stay within the storage, whose count is in elements of `dtype`.
struct PickleTensor {
  PickleStorage storage;
  Dtype dtype = Dtype::f32;
  std::int64_t offset = 0;
  std::vector<std::int64_t> shape, strides;
};

struct PickleHeap;

/// One value of a Pickle, valid as long as the Pickle lives. Values may be shared and may contain themselves:
/// whoever walks them must limit the depth.
class PickleValue {
 public:
  PickleValue(const PickleHeap* heap, std::uint32_t index) : heap_(heap), index_(index) {}
  [[nodiscard]] PickleKind kind() const;
  /// Each gives nothing when the value is of another kind.
  [[nodiscard]] std::optional<bool> boolean() const;
  [[nodiscard]] std::optional<std::int64_t> integer() const;
  [[nodiscard]] std::optional<double> number() const;  ///< integer or real
  [[nodiscard]] std::optional<std::string_view> text() const;
  [[nodiscard]] std::optional<std::span<const std::byte>> bytes() const;  ///< bytes, text or big_integer
  [[nodiscard]] const PickleArray* array() const;
  [[nodiscard]] const PickleStorage* storage() const;
  [[nodiscard]] const PickleTensor* tensor() const;
  /// "module.Name" of a global, of an object's class or of the function that would have made it; else empty.
  [[nodiscard]] std::string_view class_name() const;

  /// Number of items of a list, tuple or set, of entries of a dict, of arguments of an object.
  [[nodiscard]] std::size_t size() const;
  /// @pre i < size(). An item; the value of a dict's entry.
  [[nodiscard]] PickleValue operator[](std::size_t i) const;
  /// @pre a dict, i < size()
  [[nodiscard]] PickleValue key(std::size_t i) const;
  /// The last entry of a dict under this text, or nothing.
  [[nodiscard]] std::optional<PickleValue> find(std::string_view key) const;
  /// What an object was given to restore itself from (mostly a dict of its members), or nothing.
  [[nodiscard]] std::optional<PickleValue> state() const;

 private:
  const PickleHeap* heap_;
  std::uint32_t index_;
};

struct PickleOptions {
  /// Classes and functions that Mien does not know become `object`s without content that would need them;
  /// otherwise the first one refuses the file. Nothing is called in either case.
  bool keep_foreign = false;
};

/// A whole pickle.
class Pickle {
 public:
  /// Errors (Errc::input): unreadable, damaged or truncated; (Errc::incompatible): a class or function that
  /// Mien does not know, by name.
  static Result<Pickle> open(const std::filesystem::path& path, const PickleOptions& options = {});
  /// Reads the pickle at the beginning of `bytes`, which must outlive the result; `name` stands for the file
  /// in messages. Several pickles may follow each other: see size().
  static Result<Pickle> parse(std::span<const std::byte> bytes, std::string_view name,
                              const PickleOptions& options = {});
  Pickle(Pickle&&) noexcept;
  Pickle& operator=(Pickle&&) noexcept;
  ~Pickle();

  [[nodiscard]] PickleValue root() const;
  /// Bytes that the pickle takes.
  [[nodiscard]] std::size_t size() const;
  /// Every storage that the pickle mentions, each key once.
  [[nodiscard]] const std::vector<PickleStorage>& storages() const;

 private:
  explicit Pickle(std::unique_ptr<PickleHeap> heap);
  std::unique_ptr<PickleHeap> heap_;
};

}  // namespace mien
