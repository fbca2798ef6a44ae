#pragma once
#include <memory>
#include <string>

#include "input_file.h"
#include "sound_source.h"

namespace mien {

/// The sound of anything the FFmpeg libraries decode: compressed formats, other containers, video files.
/// Errors (Errc::input): the content is not recognised (`content` says in words what it looks like), it has
/// no sound track, its coding has no decoder, or nothing can be decoded.
Result<std::unique_ptr<SoundSource>> make_av_source(InputFile file, const std::string& content);

}  // namespace mien
