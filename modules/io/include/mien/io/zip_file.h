#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien {

struct ZipEntry {
  std::string name{};
  std::uint64_t offset = 0;       ///< of its data in the file
  std::uint64_t stored_size = 0;  ///< bytes in the file
  std::uint64_t size = 0;         ///< bytes when unpacked
  std::uint32_t crc = 0;
  bool deflated = false;
};

/// A zip archive in memory (mapped, for instance), such as PyTorch's checkpoints and NumPy's .npz; files
/// above 4 GB too. Entries are stored or deflated, not encrypted, and the archive is one file.
class ZipFile {
 public:
  /// Reads the directory at the end of `bytes`, which must outlive the object; `name` stands for the file in
  /// messages. Errors (Errc::input): no directory (truncated), entries outside the file or on top of each
  /// other, other compressions, an entry that would unpack to more than 100 times its size and 64 MB.
  static Result<ZipFile> parse(std::span<const std::byte> bytes, std::string_view name);
  /// True when `bytes` begin like a zip archive.
  static bool looks_like(std::span<const std::byte> bytes);

  [[nodiscard]] const std::vector<ZipEntry>& entries() const { return entries_; }
  /// nullptr when there is none of this name.
  [[nodiscard]] const ZipEntry* find(std::string_view entry_name) const;
  /// The content of an entry, checked against its CRC: in place when stored, else unpacked into `unpacked`.
  /// Errors (Errc::input): the data are damaged; (Errc::failed): deflated, in a build without zlib.
  Result<std::span<const std::byte>> read(const ZipEntry& entry, Bytes& unpacked) const;

 private:
  std::span<const std::byte> bytes_;
  std::string name_;
  std::vector<ZipEntry> entries_;  ///< sorted by name
};

}  // namespace mien
