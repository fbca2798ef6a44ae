#pragma once
#include <cstddef>
#include <filesystem>
#include <span>

#include "mien/base/result.h"

namespace mien {

/// Read-only view of a whole file, mapped into memory: pages are read when touched, so a file of several
/// gigabytes costs no memory until used. The view stays valid when the object is moved, and ends with it. A
/// file that another program shortens while it is mapped is outside what can be guarded against.
class MappedFile {
 public:
  MappedFile() = default;
  /// Errors (Errc::input): missing, a folder, unreadable. An empty file is fine: an empty view.
  static Result<MappedFile> open(const std::filesystem::path& path);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  [[nodiscard]] std::span<const std::byte> bytes() const { return {data_, size_}; }

 private:
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace mien
