#pragma once
#include <filesystem>

#include "mien/models/speech_encoder/encoder_config.h"

namespace mien {

/// A speech encoder small enough for a test, and what a training program reads beside it.
EncoderConfig small_encoder();
/// A model file with random weights of it.
void write_encoder(const std::filesystem::path& path);
/// A file of SAiD's 32 coefficients, each a sine of its own phase at `rate` radians a frame; makes the
/// folder.
void write_coefficients(const std::filesystem::path& path, int num_frames, double rate);
/// 16-bit PCM, mono, 16 kHz, a tone that comes and goes; makes the folder.
void write_wav(const std::filesystem::path& path, int num_samples);

}  // namespace mien
