#pragma once
#include <filesystem>

#include "mien/models/default/default_model.h"

namespace mien {

/// Writes a default model of small sizes with random weights to `path`: enough for everything that does not
/// depend on what was learnt.
/// @param brow_hidden  0: a model of format version 1, without a brow path
void write_small_model(const std::filesystem::path& path, std::int64_t brow_hidden = 12);

/// That model, loaded.
DefaultModel small_model();

}  // namespace mien
