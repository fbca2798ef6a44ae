#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "mien/base/result.h"
#include "mien/core/audio_clip.h"
#include "mien/io/npy.h"

namespace mien::datasets {

// The files of a prepared data set, as open_dataset() reads them.

/// The number at the end of the name of a frame's file, "frame_001"; nothing when there is none.
std::optional<std::int64_t> frame_number(const std::string& stem);
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
