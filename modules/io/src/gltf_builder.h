#pragma once
#include <optional>
#include <span>

#include "json_access.h"
#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien::io {

/// Collects the binary data of a new glTF file and the entries that describe it.
class GltfBuilder {
 public:
  enum Target : int { kNone = 0, kVertices = 34962, kIndices = 34963 };

  Json json;

  /// Adds bytes as a bufferView of their own, aligned to 4; returns its index.
  std::size_t add_view(std::span<const std::byte> bytes, Target target);
  template <class T>
  std::size_t add_view(const std::vector<T>& values, Target target) {
    return add_view(std::as_bytes(std::span(values)), target);
  }
  /// Adds an accessor entry; returns its index.
  std::size_t add_accessor(Json accessor);

  /// The finished file. Errors: larger than the format allows.
  Result<Bytes> finish();

 private:
  Bytes bin_;
};

}  // namespace mien::io
