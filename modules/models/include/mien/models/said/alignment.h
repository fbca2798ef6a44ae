#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/tensor/key_range.h"

namespace mien::said {

// How the denoiser ties frames of motion to frames of speech, and how it sees the number of a step.

/// The frames of context that each frame of motion may look at (the paper's alignment bias, Eq. 4): its own
/// and one to either side when there are as many of both, else a band of their ratio. Bounds are rounded to
/// nearest, ties to even, in double. @pre both counts are at least 1, or num_frames is 0
std::vector<KeyRange> aligned_keys(std::int64_t num_frames, std::int64_t num_context_frames);

/// Sinusoids of step numbers, cosines first: cos(t f_i), sin(t f_i) with f_i = 10000^(-i / h), i < h = width
/// / 2, in float32. [steps, width], one row after the other. @pre width is even
std::vector<float> step_sinusoids(std::span<const std::int64_t> steps, std::int64_t width);

}  // namespace mien::said
