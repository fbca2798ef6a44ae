#pragma once
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien {

/// Whole content of a file. Errors (Errc::input): missing, a directory, unreadable.
Result<Bytes> read_file(const std::filesystem::path& path);

/// A file that appears under its name only when complete. Until commit() it has no name at all, so that a
/// process that is killed leaves nothing behind; where the file system cannot do that (NFS, FAT), it has a
/// hidden name in the same folder, which goes when the object is destroyed without commit.
class AtomicFile {
 public:
  /// Errors (Errc::failed): the folder is missing or cannot be written.
  static Result<AtomicFile> create(const std::filesystem::path& path);
  AtomicFile(AtomicFile&&) noexcept;
  AtomicFile& operator=(AtomicFile&&) noexcept;
  ~AtomicFile();

  /// Errors (Errc::failed): e.g. the disk is full.
  Status write(std::span<const std::byte> bytes);
  /// At a place of its own, in any order; write() goes on where it was.
  Status write_at(std::size_t offset, std::span<const std::byte> bytes);
  Status commit();
  /// Name to hand to a library that writes by itself; it must be closed before commit(). It is of this
  /// process only, and need not have the extension of the file.
  [[nodiscard]] const std::filesystem::path& temporary_path() const;

 private:
  struct State;
  explicit AtomicFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// create + write + commit.
Status write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
Status write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace mien
