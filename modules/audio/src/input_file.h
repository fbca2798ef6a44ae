#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien {

/// A regular file open for reading at any place. Its size is that of the moment it was opened.
class InputFile {
 public:
  /// Errors (Errc::input): missing, a folder, not a regular file, unreadable, empty.
  static Result<InputFile> open(const std::filesystem::path& path);

  [[nodiscard]] std::int64_t size() const { return size_; }
  [[nodiscard]] const std::string& name() const { return name_; }  // in quotes, for messages
  [[nodiscard]] std::int64_t position() const { return position_; }
  void seek(std::int64_t position) { position_ = position; }
  /// Bytes read from position() on, which moves behind them; fewer than asked at the end (or when reading
  /// fails).
  std::size_t read(std::span<std::byte> out);

  /// Error about this file.
  [[nodiscard]] Error error(std::string why, std::string fix = "") const {
    return Error{Errc::input, name_, std::move(why), std::move(fix)};
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  std::string name_;
  std::int64_t size_ = 0;
  std::int64_t position_ = 0;
  std::int64_t file_position_ = 0;  // where the stream stands; seeking only on a difference keeps its buffer
};

}  // namespace mien
