#pragma once
#include <filesystem>
#include <vector>

#include "mien/train/sound_options.h"

namespace mien::train {

/// The sound of a file as a system hears it; empty where it hears nothing. Errors: of reading.
Result<std::vector<float>> heard_sound(const std::filesystem::path& path, const SoundOptions& options);

}  // namespace mien::train
