#pragma once
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/audio_clip.h"
#include "mien/core/sample_source.h"

namespace mien {

/// The shortest sound that gets a face, in samples at 16 kHz: one analysis window of 25 ms.
inline constexpr int kMinAudioSamples = 400;

/// What a file holds, as far as its header tells.
struct AudioInfo {
  std::string format;      ///< container and coding in words: "WAV, 16-bit PCM", "ogg, vorbis"
  int sample_rate_hz = 0;  ///< of the file; AudioReader always gives 16000
  int num_channels = 0;    ///< of the file; AudioReader always gives their mean
  std::optional<double>
      seconds;  ///< what the header declares; a damaged or streamed file may hold less or more
};

/// Reads any file with sound in it (recognised by content, never by name) as mono 16 kHz samples, full scale
/// [-1, 1], not clipped. Memory does not grow with the length of the file. The channels are averaged; other
/// rates are resampled with a linear-phase filter that does not move the sound in time: N samples at rate r
/// become ceil(16000 N / r).
class AudioReader final : public SampleSource {
 public:
  /// Errors (Errc::input): missing, empty, unreadable or not sound (the message names what it is instead), an
  /// impossible header, an unsupported coding, fewer than kMinAudioSamples; also those of read() for the
  /// first block.
  static Result<AudioReader> open(const std::filesystem::path& path);
  AudioReader(AudioReader&&) noexcept;
  AudioReader& operator=(AudioReader&&) noexcept;
  ~AudioReader() override;

  /// Writes the next samples to `out` and returns their number; fewer than out.size() only at the end, then
  /// 0. Errors (Errc::input), final: a sample that is NaN, infinite or absurdly large (the message names its
  /// position), a sample rate that changes on the way.
  Result<std::size_t> read(std::span<float> out) override;
  /// Opens the file again. Errors: those of open().
  Status rewind() override;

  [[nodiscard]] const AudioInfo& info() const;
  /// Oddities survived so far: the file is cut or damaged, channels cancel out, silence, clipping. Complete
  /// after the end was read; a second reading adds none.
  [[nodiscard]] const std::vector<std::string>& warnings() const;

 private:
  struct State;
  explicit AudioReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// What is left of the sound, in memory. Errors: those of AudioReader::read().
Result<AudioClip> read_all(AudioReader& reader);
/// The whole file in memory; the result carries the reader's warnings. Errors: those of AudioReader.
Result<AudioClip> load_audio(const std::filesystem::path& path);

}  // namespace mien
