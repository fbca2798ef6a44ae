#include "mien/datasets/prepared_files.h"

#include <array>
#include <cstdint>
#include <span>

#include "mien/base/file.h"
#include "mien/base/number_text.h"

namespace mien::datasets {

namespace fs = std::filesystem;

namespace {

// Mono, 32-bit float; little-endian as the machine (mien/base/bytes.h).
struct WavHeader {
  std::array<char, 4> riff{'R', 'I', 'F', 'F'};
  std::uint32_t riff_size = 0;
  std::array<char, 8> wave{'W', 'A', 'V', 'E', 'f', 'm', 't', ' '};
  std::uint32_t format_size = 16;
  std::uint16_t format = 3, num_channels = 1;  // IEEE float
  std::uint32_t sample_rate = 0, byte_rate = 0;
  std::uint16_t frame_bytes = sizeof(float), bits = 32;
  std::array<char, 4> data{'d', 'a', 't', 'a'};
  std::uint32_t data_size = 0;
};
static_assert(sizeof(WavHeader) == 44);

}  // namespace

std::optional<std::int64_t> frame_number(const std::string& stem) {
  const auto digits = stem.find_last_not_of("0123456789");
  return parse_int(std::string_view(stem).substr(digits == std::string::npos ? 0 : digits + 1));
}

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
  const auto rate = static_cast<std::uint32_t>(clip.sample_rate_hz);
  WavHeader header;
  header.data_size = static_cast<std::uint32_t>(clip.samples.size() * sizeof(float));
  header.riff_size = static_cast<std::uint32_t>(sizeof(WavHeader) - 8) + header.data_size;
  header.sample_rate = rate;
  header.byte_rate = static_cast<std::uint32_t>(rate * sizeof(float));
  MIEN_TRY(auto file, AtomicFile::create(out / "wav" / (name + ".wav")));
  MIEN_TRY([[maybe_unused]] const auto head, file.write(std::as_bytes(std::span(&header, 1))));
  MIEN_TRY([[maybe_unused]] const auto data, file.write(std::as_bytes(std::span(clip.samples))));
  return file.commit();
}

Status copy_sound(const fs::path& out, const std::string& name, const fs::path& sound) {
  MIEN_TRY(const Bytes bytes, read_file(sound));
  return write_file(out / "wav" / (name + ".wav"), std::span<const std::byte>(bytes));
}

}  // namespace mien::datasets
