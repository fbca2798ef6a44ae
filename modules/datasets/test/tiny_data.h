#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "mien/datasets/layout.h"

namespace mien::tiny {

/// A prepared data set in its true form, small: one second of sound and motion for every name, meshes of
/// `num_vertices` vertices (coefficients have the width of the layout), templates for the subjects of the
/// names.
void write_prepared(DatasetKind kind, const std::filesystem::path& folder,
                    const std::vector<std::string>& names, std::int64_t num_vertices = 4);

/// One 16 kHz sound with a quiet tone.
void write_sound(const std::filesystem::path& path, double seconds);
/// An array [N, C], or [1, N, C], whose value at (n, c) is n + c / 1000.
void write_ramp(const std::filesystem::path& path, std::int64_t num_frames, std::int64_t width,
                bool is_batch = false);
/// .vl frames frame_001.vl ... of three vertices in one folder; the last one's y is the frame's number.
void write_vl_frames(const std::filesystem::path& folder, int num_frames);
/// BEAT's JSON: `num_frames` frames of 51 weights, all n / 1000.
void write_beat_json(const std::filesystem::path& path, int num_frames, int width = 51);

}  // namespace mien::tiny
