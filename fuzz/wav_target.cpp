#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "mien/audio/load_audio.h"
#include "mien/base/contract.h"
#include "mien/base/file.h"
#include "target.h"

namespace mien::fuzz {
namespace {

struct Coding {
  std::uint16_t tag, bits;
};

// A WAV file of `frames` samples in each of two channels, with a chunk that readers have to skip.
Bytes wav_file(Coding coding, std::uint32_t rate, int frames) {
  constexpr std::uint16_t kChannels = 2;
  const auto align = static_cast<std::uint16_t>(kChannels * coding.bits / 8);
  Bytes wav;
  const auto text = [&](std::string_view s) {
    wav.insert(wav.end(), as_bytes(s).begin(), as_bytes(s).end());
  };
  const auto size = static_cast<std::uint32_t>(frames * align);
  text("RIFF");
  append_le<std::uint32_t>(wav, size + 52);
  text("WAVELIST");
  append_le<std::uint32_t>(wav, 7);
  text("INFOabc");
  append_le<std::uint8_t>(wav, 0);
  text("fmt ");
  append_le<std::uint32_t>(wav, 16);
  append_le<std::uint16_t>(wav, coding.tag);
  append_le<std::uint16_t>(wav, kChannels);
  append_le<std::uint32_t>(wav, rate);
  append_le<std::uint32_t>(wav, rate * align);
  append_le<std::uint16_t>(wav, align);
  append_le<std::uint16_t>(wav, coding.bits);
  text("data");
  append_le<std::uint32_t>(wav, size);
  for (int i = 0; i < frames * kChannels; ++i) {
    const float value = 0.3f * std::sin(0.05f * static_cast<float>(i));
    if (coding.tag == 3 && coding.bits == 32)
      append_le<float>(wav, value);
    else if (coding.tag == 3)
      append_le<double>(wav, value);
    else
      for (int byte = 0; byte < coding.bits / 8; ++byte)
        append_le<std::uint8_t>(wav, static_cast<std::uint8_t>(i));
  }
  return wav;
}

std::vector<Bytes> seeds() {
  std::vector<Bytes> files;
  for (const Coding coding :
       {Coding{1, 8}, {1, 16}, {1, 24}, {1, 32}, {3, 32}, {3, 64}, {6, 8}, {7, 8}, {2, 4}})
    files.push_back(wav_file(coding, coding.bits == 16 ? 16000 : 22050, 700));
  return files;
}

Outcome read(std::span<const std::byte> bytes) {
  // Other containers are libav's.
  constexpr std::array<std::string_view, 4> kOurs = {"RIFF", "RIFX", "RF64", "BW64"};
  const auto text = as_text(bytes);
  if (std::none_of(kOurs.begin(), kOurs.end(), [&](auto magic) { return text.starts_with(magic); }))
    return {false, "not ours"};
  struct File {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("mien_fuzz_" + std::to_string(::getpid()) + ".wav");
    ~File() { std::filesystem::remove(path); }
  };
  static const File file;
  contract(write_file(file.path, bytes).has_value(), "fuzz: the temporary folder cannot be written");
  const auto clip = load_audio(file.path);
  if (clip)
    contract(
        std::all_of(clip->samples.begin(), clip->samples.end(), [](float v) { return std::isfinite(v); }),
        "fuzz: samples are finite");
  return outcome_of(clip, clip ? clip->samples.size() : 0);
}

constexpr std::array<std::string_view, 9> kWords = {"RIFF", "RIFX", "RF64", "ds64",    "fmt ",
                                                    "data", "fact", "LIST", "\xfe\xff"};

}  // namespace

Target wav_target() { return {"wav", &seeds, &read, kWords}; }

}  // namespace mien::fuzz
