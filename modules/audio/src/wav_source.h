#pragma once
#include <memory>

#include "input_file.h"
#include "sound_source.h"
#include "wav_header.h"

namespace mien {

/// Samples of a WAV file in one of the plain codings.   @pre header.coding != WavCoding::other
std::unique_ptr<SoundSource> make_wav_source(InputFile file, WavHeader header);

}  // namespace mien
