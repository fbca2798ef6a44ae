#include "pending_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <utility>

namespace mien {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kMode = 0644;

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// Writes that a file system keeps back until close(), and their errors, happen now.
int flush(int descriptor) {
  const int copy = ::dup(descriptor);
  return copy < 0 || ::close(copy) != 0 ? errno : 0;
}

int link_to(const fs::path& from, const fs::path& to) {
  return ::linkat(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), AT_SYMLINK_FOLLOW) == 0 ? 0 : errno;
}

}  // namespace

fs::path PendingFile::hidden_name(const fs::path& final_path) {
  fs::path name = final_path;
  name.replace_filename("." + final_path.stem().string() + ".partial-" + std::to_string(::getpid()) +
                        final_path.extension().string());
  return name;
}

std::optional<PendingFile> PendingFile::unnamed(const fs::path& final_path) {
#ifdef O_TMPFILE
  const int descriptor = ::open(folder_of(final_path).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, kMode);
  if (descriptor < 0) return std::nullopt;
  PendingFile file(descriptor, "/proc/self/fd/" + std::to_string(descriptor), false);
  if (::access(file.path_.c_str(), F_OK) != 0) return std::nullopt;
  return file;
#else
  (void)final_path;
  return std::nullopt;
#endif
}

std::optional<PendingFile> PendingFile::hidden(const fs::path& final_path) {
  const fs::path name = hidden_name(final_path);
  const int descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode);
  if (descriptor < 0) return std::nullopt;
  return PendingFile(descriptor, name, true);
}

PendingFile::PendingFile(PendingFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      path_(std::move(other.path_)),
      has_name_(std::exchange(other.has_name_, false)) {}

PendingFile& PendingFile::operator=(PendingFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(path_, other.path_);
  std::swap(has_name_, other.has_name_);
  return *this;
}

PendingFile::~PendingFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (has_name_) ::unlink(path_.c_str());
}

int PendingFile::appear(const fs::path& final_path) {
  if (const int error = flush(descriptor_); error != 0) return error;
  if (!has_name_) {
    // A link replaces nothing. Where something has the name, the file gets the hidden one for a moment.
    int error = link_to(path_, final_path);
    if (error != EEXIST) return error;
    const fs::path name = hidden_name(final_path);
    error = link_to(path_, name);
    if (error == EEXIST && ::unlink(name.c_str()) == 0) error = link_to(path_, name);
    if (error != 0) return error;
    path_ = name;
    has_name_ = true;
  }
  if (std::rename(path_.c_str(), final_path.c_str()) != 0) return errno;
  has_name_ = false;
  return 0;
}

}  // namespace mien
