#include "mien/base/file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>

namespace mien {
namespace {

namespace fs = std::filesystem;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }
std::string reason(int error_number) { return std::generic_category().message(error_number); }

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
  fs::path temporary_path;
  int descriptor = -1;

  ~State() {
    if (descriptor >= 0) ::close(descriptor);
    if (!temporary_path.empty()) {
      std::error_code ignored;
      fs::remove(temporary_path, ignored);
    }
  }
};

AtomicFile::AtomicFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
AtomicFile::AtomicFile(AtomicFile&&) noexcept = default;
AtomicFile& AtomicFile::operator=(AtomicFile&&) noexcept = default;
AtomicFile::~AtomicFile() = default;

Result<AtomicFile> AtomicFile::create(const fs::path& path) {
  std::error_code ec;
  if (fs::is_directory(path, ec))
    return Error{Errc::failed, quoted(path), "is a folder, expected a file name to write", ""};
  auto state = std::make_unique<State>();
  state->final_path = path;
  // The extension stays last: libraries choose a format by it.
  fs::path temporary = path;
  temporary.replace_filename("." + path.stem().string() + ".partial-" + std::to_string(::getpid()) +
                             path.extension().string());
  state->descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (state->descriptor < 0)
    return Error{Errc::failed, quoted(path), "cannot be written: " + reason(errno),
                 "Check that the folder exists and may be written to"};
  state->temporary_path = temporary;
  return AtomicFile(std::move(state));
}

Status AtomicFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(state_->descriptor, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return Error{Errc::failed, quoted(state_->final_path), "writing failed: " + reason(errno), ""};
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return Done{};
}

Status AtomicFile::commit() {
  const int descriptor = state_->descriptor;
  state_->descriptor = -1;
  if (::close(descriptor) != 0)
    return Error{Errc::failed, quoted(state_->final_path), "writing failed: " + reason(errno), ""};
  std::error_code ec;
  fs::rename(state_->temporary_path, state_->final_path, ec);
  if (ec) return Error{Errc::failed, quoted(state_->final_path), "cannot be written: " + ec.message(), ""};
  state_->temporary_path.clear();
  return Done{};
}

const fs::path& AtomicFile::temporary_path() const { return state_->temporary_path; }

Status write_file(const fs::path& path, std::span<const std::byte> bytes) {
  MIEN_TRY(auto file, AtomicFile::create(path));
  MIEN_TRY([[maybe_unused]] const auto written, file.write(bytes));
  return file.commit();
}

Status write_file(const fs::path& path, std::string_view text) { return write_file(path, as_bytes(text)); }

}  // namespace mien
