#include "prepared_files.h"

#include "mien/base/file.h"

namespace mien::datasets {

namespace fs = std::filesystem;

Status make_folders(const fs::path& out) {
  for (const char* name : {"wav", "vertices_npy"}) {
    std::error_code ec;
    fs::create_directories(out / name, ec);
    if (ec)
      return Error{Errc::failed, "'" + (out / name).string() + "'", "cannot be made: " + ec.message(), ""};
  }
  return Done{};
}

Status write_motion_array(const fs::path& out, const std::string& name, const NpyArray& motion) {
  return write_file(out / "vertices_npy" / (name + ".npy"), std::span<const std::byte>(write_npy(motion)));
}

Status write_sound(const fs::path& out, const std::string& name, const AudioClip& clip) {
  constexpr std::uint16_t kFloatFormat = 3, kMono = 1, kBits = 32;
  const auto rate = static_cast<std::uint32_t>(clip.sample_rate_hz);
  const auto size = static_cast<std::uint32_t>(clip.samples.size() * sizeof(float));
  Bytes bytes;
  const auto text = [&](std::string_view word) {
    const auto part = as_bytes(word);
    bytes.insert(bytes.end(), part.begin(), part.end());
  };
  text("RIFF");
  append_le(bytes, std::uint32_t{36} + size);
  text("WAVEfmt ");
  append_le(bytes, std::uint32_t{16});
  append_le(bytes, kFloatFormat);
  append_le(bytes, kMono);
  append_le(bytes, rate);
  append_le(bytes, static_cast<std::uint32_t>(rate * sizeof(float)));
  append_le(bytes, static_cast<std::uint16_t>(sizeof(float)));
  append_le(bytes, kBits);
  text("data");
  append_le(bytes, size);
  const auto data = std::as_bytes(std::span(clip.samples));
  bytes.insert(bytes.end(), data.begin(), data.end());
  return write_file(out / "wav" / (name + ".wav"), std::span<const std::byte>(bytes));
}

Status copy_sound(const fs::path& out, const std::string& name, const fs::path& sound) {
  MIEN_TRY(const Bytes bytes, read_file(sound));
  return write_file(out / "wav" / (name + ".wav"), std::span<const std::byte>(bytes));
}

}  // namespace mien::datasets
