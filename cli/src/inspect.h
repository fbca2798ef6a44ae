#pragma once
#include <filesystem>

#include "facts.h"
#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/io/safetensors.h"

namespace mien {

// What a file is and holds, one kind each.
Result<Facts> inspect_audio(const std::filesystem::path& path);
/// A safetensors file: a model of Mien, else whatever tensors it holds.
Result<Facts> inspect_model(const std::filesystem::path& path, const SafetensorsFile& file);
Result<Facts> inspect_character(const std::filesystem::path& path);
Result<Facts> inspect_motion(const std::filesystem::path& path);
/// Channels, length and ranges.
void add_motion_facts(const Motion& motion, Facts& facts);

}  // namespace mien
