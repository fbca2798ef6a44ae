#include "wav_header.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "mien/base/number_text.h"
#include "sound_source.h"

namespace mien {
namespace {

// Format tags (mmreg.h of the Windows SDK).
constexpr std::uint16_t kTagPcm = 1, kTagMsAdpcm = 2, kTagFloat = 3, kTagALaw = 6, kTagMuLaw = 7,
                        kTagImaAdpcm = 0x11, kTagMp3 = 0x55, kTagExtensible = 0xFFFE;
std::string tag_text(std::uint16_t tag) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text = "0x";
  for (int shift = 12; shift >= 0; shift -= 4) text += kDigits[(tag >> shift) & 15];
  return tag == kTagMp3 ? text + " (MP3)" : text;
}

Result<WavHeader> read_format(InputFile& file, const RiffChunk& chunk) {
  std::array<std::byte, 40> bytes{};
  file.seek(chunk.start);
  const std::size_t want = static_cast<std::size_t>(std::min<std::int64_t>(chunk.size, 40));
  const std::size_t got = file.read(std::span(bytes).first(want));
  if (chunk.size < 16 || got < want)
    return file.error("damaged WAV header: the 'fmt ' chunk has " + std::to_string(got) +
                      " bytes, at least 16 needed");
  auto tag = *read_le<std::uint16_t>(bytes, 0);
  const int channels = *read_le<std::uint16_t>(bytes, 2);
  const auto rate = *read_le<std::uint32_t>(bytes, 4);
  const int block_align = *read_le<std::uint16_t>(bytes, 12);
  const int bits = *read_le<std::uint16_t>(bytes, 14);
  if (tag == kTagExtensible) {
    // The first two bytes of the sub-format's identifier are the tag; the other fourteen are always the same.
    constexpr std::string_view kGuidTail("\x00\x00\x00\x00\x10\x00\x80\x00\x00\xaa\x00\x38\x9b\x71", 14);
    if (got < 40 || as_text(std::span(bytes).subspan(26, 14)) != kGuidTail)
      return file.error("damaged WAV header: extensible format without a known sub-format", kAcceptedFormats);
    tag = *read_le<std::uint16_t>(bytes, 24);
  }
  if (channels < 1 || channels > kMaxChannels)
    return file.error("the WAV header declares " + std::to_string(channels) + " channels, expected 1 to " +
                      std::to_string(kMaxChannels));
  if (rate < kMinSampleRateHz || rate > kMaxSampleRateHz)
    return file.error("the WAV header declares a sample rate of " + std::to_string(rate) + " Hz, expected " +
                      std::to_string(kMinSampleRateHz) + " to " + std::to_string(kMaxSampleRateHz));

  WavHeader header{.num_channels = channels, .sample_rate_hz = static_cast<int>(rate)};
  const auto set = [&](WavCoding coding, int size, std::string name) {
    header.coding = coding;
    header.bytes_per_sample = size;
    header.coding_name = std::move(name);
  };
  if (tag == kTagPcm && bits == 8) set(WavCoding::pcm_u8, 1, "8-bit PCM");
  if (tag == kTagPcm && bits == 16) set(WavCoding::pcm_s16, 2, "16-bit PCM");
  if (tag == kTagPcm && bits == 24) set(WavCoding::pcm_s24, 3, "24-bit PCM");
  if (tag == kTagPcm && bits == 32) set(WavCoding::pcm_s32, 4, "32-bit PCM");
  if (tag == kTagFloat && bits == 32) set(WavCoding::float32, 4, "32-bit float");
  if (tag == kTagFloat && bits == 64) set(WavCoding::float64, 8, "64-bit float");
  if (tag == kTagALaw && bits == 8) set(WavCoding::a_law, 1, "A-law");
  if (tag == kTagMuLaw && bits == 8) set(WavCoding::mu_law, 1, "mu-law");
  if (tag == kTagMsAdpcm || tag == kTagImaAdpcm) {
    set(WavCoding::other, 0, tag == kTagMsAdpcm ? "Microsoft ADPCM" : "IMA ADPCM");
    return header;
  }
  if (header.bytes_per_sample == 0)
    return file.error("WAV with format tag " + tag_text(tag) + " and " + std::to_string(bits) +
                          " bits per sample, expected PCM of 8, 16, 24 or 32 bits, float of 32 or 64, A-law, "
                          "mu-law or ADPCM",
                      "Convert it to 16-bit PCM");
  if (const int frame = channels * header.bytes_per_sample; block_align != frame)
    header.warnings.push_back("the WAV header declares " + std::to_string(block_align) +
                              " bytes per frame, but " + header.coding_name + " needs " +
                              std::to_string(frame) + "; the latter is used");
  return header;
}

// Fits the declared size of the samples to the file.
void measure_data(InputFile& file, const RiffChunk& chunk, RiffKind kind, WavHeader& header) {
  const std::int64_t rest = std::max<std::int64_t>(0, file.size() - chunk.start);
  header.data_start = chunk.start;
  header.data_size = std::min(chunk.size, rest);
  if (header.coding == WavCoding::other) return;
  const std::int64_t frame = static_cast<std::int64_t>(header.num_channels) * header.bytes_per_sample;
  const auto seconds = [&](std::int64_t bytes) {
    return fixed(static_cast<double>(bytes / frame) / header.sample_rate_hz, 3) + " s";
  };
  if (chunk.size == 0 && rest > 0 && !only_chunks_follow(file, kind, chunk.start)) {
    header.data_size = rest;
    header.warnings.push_back("the WAV header declares no samples, but " + seconds(rest) +
                              " follow (an interrupted recording?); they are used");
  } else if (chunk.is_endless) {
    header.data_size = rest;
  } else if (chunk.size > rest) {
    header.warnings.push_back("the file is cut: its header declares " + seconds(chunk.size) +
                              ", but it ends after " + seconds(rest));
  }
  if (header.data_size % frame != 0) {
    header.data_size -= header.data_size % frame;
    header.warnings.push_back("the samples end in the middle of a frame; the incomplete frame is left out");
  }
}

}  // namespace

Result<WavHeader> read_wav_header(InputFile& file, RiffKind kind) {
  if (kind == RiffKind::rifx)
    return file.error("big-endian WAV (RIFX) is not supported", "Convert it to an ordinary WAV file");
  std::optional<RiffChunk> format, data;
  RiffChunks chunks(file, kind);
  while (!(format && data)) {
    const auto chunk = chunks.next();
    if (!chunk) break;
    if (chunk->is("fmt ") && !format) {
      format = chunk;
    } else if (chunk->is("data") && !data) {
      data = chunk;
    } else if (chunk->start + chunk->size > file.size()) {
      return file.error("damaged WAV file: a chunk before the samples claims " + std::to_string(chunk->size) +
                        " bytes, but only " + std::to_string(file.size() - chunk->start) + " follow");
    }
  }
  if (!format) return file.error("damaged WAV file: no 'fmt ' chunk, so its sample format is unknown");
  MIEN_TRY(WavHeader header, read_format(file, *format));
  if (!data) return file.error("damaged WAV file: no 'data' chunk, so it holds no sound");
  measure_data(file, *data, kind, header);
  return header;
}

}  // namespace mien
