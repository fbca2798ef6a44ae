#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "input_file.h"
#include "mien/base/result.h"
#include "riff_chunks.h"

namespace mien {

/// How the samples of a WAV file are coded.
enum class WavCoding { pcm_u8, pcm_s16, pcm_s24, pcm_s32, float32, float64, a_law, mu_law, other };

/// What the header of a WAV file (of any family in riff_chunks.h) says, checked against the size of the file.
struct WavHeader {
  WavCoding coding = WavCoding::other;  // other: a known compressed coding, left to the general decoder
  std::string coding_name{};            // "16-bit PCM"
  int num_channels = 0;
  int sample_rate_hz = 0;
  int bytes_per_sample = 0;     // 0 for other
  std::int64_t data_start = 0;  // first byte of the samples
  std::int64_t data_size = 0;   // bytes that are really there
  std::vector<std::string> warnings{};
};

/// @pre kind is not none. Errors (Errc::input): no fmt or data chunk, an impossible or unsupported format,
/// big-endian (RIFX).
Result<WavHeader> read_wav_header(InputFile& file, RiffKind kind);

}  // namespace mien
