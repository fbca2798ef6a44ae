#include "mien/base/file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "pending_file.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }
std::string reason(int error_number) { return std::generic_category().message(error_number); }

// Calls write_some(rest), which returns how much it wrote or -1, until nothing is left.
template <class WriteSome>
Status write_all(const fs::path& path, std::span<const std::byte> bytes, WriteSome write_some) {
  while (!bytes.empty()) {
    const ssize_t n = write_some(bytes);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0)
      return Error{Errc::failed, quoted(path), "writing failed: " + reason(errno),
                   errno == ENOSPC ? "Free some disk space" : ""};
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return Done{};
}

}  // namespace

Result<Bytes> read_file(const fs::path& path) {
  std::error_code ec;
  const auto status = fs::status(path, ec);
  if (status.type() == fs::file_type::not_found)
    return Error{Errc::input, quoted(path), "file not found", "Check the name and the folder"};
  if (status.type() == fs::file_type::directory)
    return Error{Errc::input, quoted(path), "is a folder, expected a file", ""};
  std::FILE* raw = std::fopen(path.c_str(), "rb");
  if (raw == nullptr) return Error{Errc::input, quoted(path), "cannot be opened: " + reason(errno), ""};
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(raw, &std::fclose);
  Bytes bytes;
  const auto size = fs::file_size(path, ec);
  if (!ec) bytes.reserve(size);
  std::byte block[1 << 16];
  for (;;) {
    const std::size_t n = std::fread(block, 1, sizeof block, raw);
    bytes.insert(bytes.end(), block, block + n);
    if (n < sizeof block) break;
  }
  if (std::ferror(raw) != 0) return Error{Errc::input, quoted(path), "cannot be read: " + reason(errno), ""};
  return bytes;
}

struct AtomicFile::State {
  fs::path final_path;
  PendingFile file;
};

AtomicFile::AtomicFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
AtomicFile::AtomicFile(AtomicFile&&) noexcept = default;
AtomicFile& AtomicFile::operator=(AtomicFile&&) noexcept = default;
AtomicFile::~AtomicFile() = default;

Result<AtomicFile> AtomicFile::create(const fs::path& path) {
  const auto unwritable = [&](int error_number) {
    return Error{Errc::failed, quoted(path), "cannot be written: " + reason(error_number),
                 "Check that the folder exists and may be written to"};
  };
  std::error_code ec;
  if (fs::is_directory(path, ec))
    return Error{Errc::failed, quoted(path), "is a folder, expected a file name to write", ""};
  // A name that cannot be given at the end, such as one that is too long, is an error at the start.
  struct stat ignored;
  if (::lstat(PendingFile::hidden_name(path).c_str(), &ignored) != 0 && errno != ENOENT)
    return unwritable(errno);
  auto file = PendingFile::unnamed(path);
  if (!file) file = PendingFile::hidden(path);
  if (!file) return unwritable(errno);
  return AtomicFile(std::make_unique<State>(State{path, std::move(*file)}));
}

Status AtomicFile::write(std::span<const std::byte> bytes) {
  return write_all(state_->final_path, bytes, [&](std::span<const std::byte> rest) {
    return ::write(state_->file.descriptor(), rest.data(), rest.size());
  });
}

Status AtomicFile::write_at(std::size_t offset, std::span<const std::byte> bytes) {
  return write_all(state_->final_path, bytes, [&](std::span<const std::byte> rest) {
    const auto at = static_cast<off_t>(offset + (bytes.size() - rest.size()));
    return ::pwrite(state_->file.descriptor(), rest.data(), rest.size(), at);
  });
}

Status AtomicFile::commit() {
  if (const int error = state_->file.appear(state_->final_path); error != 0)
    return Error{Errc::failed, quoted(state_->final_path), "cannot be written: " + reason(error), ""};
  return Done{};
}

const fs::path& AtomicFile::temporary_path() const { return state_->file.path(); }

Status write_file(const fs::path& path, std::span<const std::byte> bytes) {
  MIEN_TRY(auto file, AtomicFile::create(path));
  MIEN_TRY([[maybe_unused]] const auto written, file.write(bytes));
  return file.commit();
}

Status write_file(const fs::path& path, std::string_view text) { return write_file(path, as_bytes(text)); }

}  // namespace mien
