#include "mien/io/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace mien {
namespace {

Error open_error(const std::filesystem::path& path, int error_number) {
  const std::string name = "'" + path.string() + "'";
  if (error_number == ENOENT) return {Errc::input, name, "file not found", "Check the name and the folder"};
  return {Errc::input, name, "cannot be read: " + std::generic_category().message(error_number), ""};
}

struct Descriptor {
  int value;
  ~Descriptor() { ::close(value); }
};

}  // namespace

Result<MappedFile> MappedFile::open(const std::filesystem::path& path) {
  const int raw = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (raw < 0) return open_error(path, errno);
  const Descriptor descriptor{raw};  // the mapping outlives it
  struct stat info {};
  if (::fstat(raw, &info) != 0) return open_error(path, errno);
  if (S_ISDIR(info.st_mode)) return open_error(path, EISDIR);
  if (!S_ISREG(info.st_mode))
    return Error{Errc::input, "'" + path.string() + "'", "is not a regular file, which is needed to map it",
                 ""};
  MappedFile file;
  if (info.st_size == 0) return file;
  void* data = ::mmap(nullptr, static_cast<std::size_t>(info.st_size), PROT_READ, MAP_PRIVATE, raw, 0);
  if (data == MAP_FAILED) return open_error(path, errno);
  file.data_ = static_cast<const std::byte*>(data);
  file.size_ = static_cast<std::size_t>(info.st_size);
  return file;
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(const_cast<std::byte*>(data_), size_);
}

}  // namespace mien
