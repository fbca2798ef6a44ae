#pragma once
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/bytes.h"

namespace mien {

/// A file that exists as long as the object.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::span<const std::byte> bytes, std::string_view ending = ".wav") {
    static std::atomic<int> counter{0};
    path_ = std::filesystem::temp_directory_path() / ("mien_audio_" + std::to_string(getpid()) + "_" +
                                                      std::to_string(counter++) + std::string(ending));
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// What the header of a WAV file says; every field can lie.
struct WavFields {
  std::uint16_t tag = 1;
  std::uint16_t num_channels = 1;
  std::uint32_t sample_rate_hz = 16000;
  std::uint16_t bits = 16;
  int block_align = -1;         // -1: the right one
  std::int64_t data_size = -1;  // -1: the right one
};

inline void append_text(Bytes& bytes, std::string_view text) {
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
}

/// "fmt " chunk of 16 bytes.
inline void append_format(Bytes& wav, const WavFields& f) {
  const int align = f.block_align >= 0 ? f.block_align : f.num_channels * f.bits / 8;
  append_text(wav, "fmt ");
  append_le<std::uint32_t>(wav, 16);
  append_le<std::uint16_t>(wav, f.tag);
  append_le<std::uint16_t>(wav, f.num_channels);
  append_le<std::uint32_t>(wav, f.sample_rate_hz);
  append_le<std::uint32_t>(wav, f.sample_rate_hz * static_cast<std::uint32_t>(align));
  append_le<std::uint16_t>(wav, static_cast<std::uint16_t>(align));
  append_le<std::uint16_t>(wav, f.bits);
}

inline Bytes wav_file(const WavFields& f, const Bytes& data) {
  Bytes wav;
  append_text(wav, "RIFF");
  append_le<std::uint32_t>(wav, static_cast<std::uint32_t>(36 + data.size()));
  append_text(wav, "WAVE");
  append_format(wav, f);
  append_text(wav, "data");
  append_le<std::uint32_t>(wav, static_cast<std::uint32_t>(
                                    f.data_size >= 0 ? f.data_size : static_cast<std::int64_t>(data.size())));
  wav.insert(wav.end(), data.begin(), data.end());
  return wav;
}

template <class T>
Bytes as_data(const std::vector<T>& values) {
  Bytes data;
  for (const T v : values) append_le<T>(data, v);
  return data;
}

/// 16-bit values of a rising and falling tone, `n` of them.
inline std::vector<std::int16_t> ramp16(std::size_t n) {
  std::vector<std::int16_t> values(n);
  for (std::size_t i = 0; i < n; ++i)
    values[i] = static_cast<std::int16_t>((static_cast<int>(i) * 97) % 20001 - 10000);
  return values;
}

}  // namespace mien
