#include "audio_file.h"

#include <sndfile.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "mien/base/file.h"
#include "mien/core/audio_clip.h"

namespace mien {

Status write_audio(const std::filesystem::path& path, std::span<const float> samples) {
  std::vector<std::int16_t> pcm(samples.size());
  for (std::size_t i = 0; i < pcm.size(); ++i)
    pcm[i] = static_cast<std::int16_t>(std::lround(std::clamp(samples[i] * 32767.0f, -32768.0f, 32767.0f)));
  MIEN_TRY(auto file, AtomicFile::create(path));
  SF_INFO info{};
  info.samplerate = kModelSampleRateHz;
  info.channels = 1;
  info.format = (path.extension() == ".flac" ? SF_FORMAT_FLAC : SF_FORMAT_WAV) | SF_FORMAT_PCM_16;
  SNDFILE* out = sf_open(file.temporary_path().c_str(), SFM_WRITE, &info);
  if (out == nullptr) return Error{Errc::failed, "'" + path.string() + "'", sf_strerror(nullptr), ""};
  const auto written = sf_write_short(out, pcm.data(), static_cast<sf_count_t>(pcm.size()));
  sf_close(out);
  if (written != static_cast<sf_count_t>(pcm.size()))
    return Error{Errc::failed, "'" + path.string() + "'", "writing failed (disk full?)", ""};
  return file.commit();
}

}  // namespace mien
