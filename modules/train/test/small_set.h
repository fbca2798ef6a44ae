#pragma once
#include <filesystem>

namespace mien::train {

/// Writes a prepared set of 24 seconds and two takes: "speech" whose level moves the jaw, with blinks and
/// brow raises at regular times. Returns its path.
std::filesystem::path write_small_set(const std::filesystem::path& path);

}  // namespace mien::train
