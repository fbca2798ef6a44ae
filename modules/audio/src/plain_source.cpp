// In place of av_source.cpp where the FFmpeg libraries are absent.
#include "av_source.h"

namespace mien {

Result<std::unique_ptr<SoundSource>> make_av_source(InputFile file, const std::string& /*content*/) {
  return file.error("is no plain WAV, and this program was built without decoders",
                    "Convert it: ffmpeg -i FILE -ac 1 -ar 16000 sound.wav");
}

}  // namespace mien
