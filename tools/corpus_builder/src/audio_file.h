#pragma once
#include <filesystem>
#include <span>
#include <string_view>

#include "mien/base/result.h"

namespace mien {

/// Writes mono 16 kHz sound with 16 bits as .wav or .flac, by the ending of the name. Values beyond full
/// scale are clipped. Error (Errc::failed): the file cannot be written.
Status write_audio(const std::filesystem::path& path, std::span<const float> samples_16k);

}  // namespace mien
