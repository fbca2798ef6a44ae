#include "sound_input.h"

#include "mien/audio/load_audio.h"
#include "mien/models/probtalk3d/conventions.h"
#include "mien/models/speech_encoder/network.h"

namespace mien::train {

Result<std::vector<float>> heard_sound(const std::filesystem::path& path, const SoundOptions& options) {
  if (!options.encoder) return std::vector<float>();
  MIEN_TRY(AudioClip clip, load_audio(path));
  std::vector<float> samples = std::move(clip.samples);
  if (options.stretches) mien::probtalk3d::stretch_waveform(samples);
  if (options.encoder->do_normalize) normalise_waveform(samples, options.encoder->normalise_eps);
  return samples;
}

}  // namespace mien::train
