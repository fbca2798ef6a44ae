#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/motion.h"

namespace mien {

/// The rate of SAiD's coefficients (specification of SAiD, section 1.3).
inline constexpr double kCoefficientFps = 60;

/// A file of coefficients as SAiD's programs name it: <person>/sentenceNN.csv, and of generated repetitions
/// <person>/sentenceNN-<repetition>.csv (section 1.4).
struct CoefficientFile {
  std::string person;
  int sentence = 0;
  std::string repetition;  ///< what stands behind the hyphen; empty: there is none
  std::filesystem::path path;
};

/// All such files of a folder and its persons' folders, by person, sentence and repetition (numbers as
/// numbers). Files that lie in the folder itself have no person. Others are left out, with a warning that
/// counts them. Errors (Errc::input): a folder that cannot be listed, or without any such file.
Result<std::vector<CoefficientFile>> list_coefficients(const std::filesystem::path& folder);

/// One file as SAiD's 32 coefficients in their order at 60 frames a second, gathered by name; others are left
/// out. (The authors' programs ignore the names and take the columns as they come.) Errors: those of reading;
/// Errc::incompatible for a coefficient that is missing or a file at another rate.
Result<Motion> read_coefficients(const std::filesystem::path& path);

/// "train", "val" or "test" of one of VOCASET's speakers; empty for others (section 1.4).
std::string_view coefficient_split(std::string_view person);

}  // namespace mien
