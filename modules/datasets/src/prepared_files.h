#pragma once
#include <filesystem>
#include <string>

#include "mien/base/result.h"
#include "mien/core/audio_clip.h"
#include "mien/io/npy.h"

namespace mien::datasets {

/// Makes <out>/wav and <out>/vertices_npy. Errors (Errc::failed).
Status make_folders(const std::filesystem::path& out);
/// <out>/vertices_npy/<name>.npy
Status write_motion_array(const std::filesystem::path& out, const std::string& name, const NpyArray& motion);
/// <out>/wav/<name>.wav, mono 32-bit float.
Status write_sound(const std::filesystem::path& out, const std::string& name, const AudioClip& clip);
/// <out>/wav/<name>.wav, the bytes of another file.
Status copy_sound(const std::filesystem::path& out, const std::string& name,
                  const std::filesystem::path& sound);

}  // namespace mien::datasets
