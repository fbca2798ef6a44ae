#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mien/audio/load_audio.h"
#include "mien/base/result.h"

namespace mien {

/// Decoded sound as it is in the file: interleaved channels, full scale [-1, 1].
struct SoundBlock {
  std::vector<float> samples;  // [n, num_channels]
  int num_channels = 0;

  [[nodiscard]] std::int64_t num_frames() const {
    return num_channels == 0 ? 0 : static_cast<std::int64_t>(samples.size()) / num_channels;
  }
};

/// Something that decodes one file, block by block. Its rate never changes; its number of channels may.
class SoundSource {
 public:
  virtual ~SoundSource() = default;
  /// The next block, empty at the end.
  virtual Status read(SoundBlock& block) = 0;
  [[nodiscard]] const AudioInfo& info() const { return info_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 protected:
  AudioInfo info_;
  std::vector<std::string> warnings_;
};

/// Headers outside these limits are refused.
inline constexpr int kMaxChannels = 64;
inline constexpr std::int64_t kMinSampleRateHz = 1000;
inline constexpr std::int64_t kMaxSampleRateHz = 768000;

inline constexpr const char* kAcceptedFormats =
    "Accepted: WAV, AIFF, FLAC, Ogg (Vorbis, Opus), MP3, M4A, WavPack, and video files with a sound track";

}  // namespace mien
