#pragma once
#include <filesystem>
#include <functional>
#include <vector>

#include "mien/console/console_exit.h"
#include "mien/datasets/coefficient_folder.h"
#include "mien/train/coefficient_window.h"

namespace mien::train {

/// Sequences to learn from, and others to look at.
struct CoefficientData {
  std::vector<CoefficientSequence> train, valid;
};

/// Reads a folder of coefficients: VOCASET's training and validation speakers, or everything to learn from
/// where none of its training speakers is there. Sequences without a frame are left out.
/// @param sound_of  the sound file of a sequence; those without are left out with a warning. Empty: no sound
/// is
///                  read
/// Errors: what cannot be read; nothing is left to learn from (Errc::incompatible).
Result<CoefficientData> read_coefficient_data(
    const std::filesystem::path& folder,
    const std::function<std::filesystem::path(const CoefficientFile&)>& sound_of, ConsoleProgress& progress);

/// Deviations of the coefficients [K] from a file with one row (coeffs_std.csv). Errors: what cannot be read;
/// more rows, and deviations that nothing can be divided by (Errc::incompatible).
Result<std::vector<float>> read_deviation(const std::filesystem::path& path);
/// The same, measured on sequences.
Result<std::vector<float>> measure_deviation(const std::vector<CoefficientSequence>& sequences);

}  // namespace mien::train
