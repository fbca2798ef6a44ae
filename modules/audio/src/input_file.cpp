#include "input_file.h"

#include <cerrno>
#include <system_error>

namespace mien {

namespace fs = std::filesystem;

Result<InputFile> InputFile::open(const fs::path& path) {
  InputFile input;
  input.name_ = '\'' + path.string() + '\'';
  std::error_code ec;
  const auto type = fs::status(path, ec).type();
  if (type == fs::file_type::not_found) return input.error("file not found", "Check the name and the folder");
  if (type == fs::file_type::directory) return input.error("is a folder, expected a file with sound");
  if (type != fs::file_type::regular)
    return input.error("is not a regular file", "Save the sound to a file first");
  input.file_.reset(std::fopen(path.c_str(), "rb"));
  if (!input.file_) return input.error("cannot be opened: " + std::generic_category().message(errno));
  const auto size = fs::file_size(path, ec);
  if (ec) return input.error("cannot be read: " + ec.message());
  if (size == 0) return input.error("the file is empty (0 bytes)", "Record or export it again");
  input.size_ = static_cast<std::int64_t>(size);
  return input;
}

std::size_t InputFile::read(std::span<std::byte> out) {
  if (position_ != file_position_ && fseeko(file_.get(), position_, SEEK_SET) != 0) return 0;
  const std::size_t n = std::fread(out.data(), 1, out.size(), file_.get());
  position_ += static_cast<std::int64_t>(n);
  file_position_ = position_;
  return n;
}

}  // namespace mien
