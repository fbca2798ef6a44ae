#pragma once
#include <filesystem>

#include "mien/models/speech_encoder/encoder_config.h"

namespace mien {

/// A speech encoder small enough for a test, and what a training program reads beside it.
EncoderConfig small_encoder();
/// A model file with random weights of it.
void write_encoder(const std::filesystem::path& path);
/// 16-bit PCM, mono, 16 kHz, a tone that comes and goes; makes the folder.
void write_wav(const std::filesystem::path& path, int num_samples);

}  // namespace mien
