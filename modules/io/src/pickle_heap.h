#pragma once
#include <cstdint>
#include <deque>
#include <string>
#include <unordered_map>
#include <vector>

#include "mien/io/mapped_file.h"
#include "mien/io/pickle.h"

namespace mien {

using PickleRef = std::uint32_t;
inline constexpr PickleRef kNoRef = 0xffffffffu;

struct PickleNode {
  PickleKind kind = PickleKind::none;
  PickleRef state = kNoRef;  ///< of an object
  std::uint32_t record =
      0;  ///< place in arrays, dtypes, node_storages or tensors; of an object: its arguments
  std::int64_t integer = 0;  ///< also a truth value
  double real = 0;
  std::string_view text{};         ///< text, bytes, name of a global, of an object's class
  std::vector<PickleRef> items{};  ///< of a dict: key, value, key, value ...
};

struct NumpyType {
  char kind = 0;
  std::size_t item_size = 0;
  bool big_endian = false;
};

/// All values of a pickle in one pool: they refer to each other by number, so cycles and deep nesting cost
/// nothing, not even when they are destroyed.
struct PickleHeap {
  MappedFile file;  ///< when the pickle was opened by name
  std::vector<PickleNode> nodes;
  std::deque<Bytes> made;                                    ///< bytes that are not in the file as they are
  std::unordered_map<const char*, std::string_view> latin1;  ///< decoded once, however often it is asked for
  std::vector<PickleArray> arrays;
  std::vector<NumpyType> dtypes;
  std::vector<PickleStorage> node_storages;
  std::vector<PickleTensor> tensors;
  std::vector<PickleStorage> storages;
  std::unordered_map<std::string_view, std::size_t> storage_index;
  PickleRef root = 0;
  std::size_t size = 0;

  std::string_view keep(Bytes bytes) { return as_text(made.emplace_back(std::move(bytes))); }
};

}  // namespace mien
