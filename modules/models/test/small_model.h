#pragma once
#include <filesystem>

#include "mien/models/default/default_model.h"

namespace mien {

/// Writes a default model of small sizes with random weights to `path`: enough for everything that does not
/// depend on what was learnt. Without raises its brow path never decides for one.
void write_small_model(const std::filesystem::path& path, bool raises_brows = true);

/// That model, loaded.
DefaultModel small_model();

}  // namespace mien
