#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mien/core/motion.h"

namespace mien {

/// What a fit gave, and what it left over.
struct FitOutcome {
  Motion motion;                 ///< coefficients, or parameters of FLAME
  std::vector<double> residual;  ///< [N] of the whole face
  std::map<std::string, std::vector<double>> region_residual;
  double mm_per_residual = 1000;  ///< length of a unit of the residuals
  double mm_per_unit = 1000;      ///< length of a unit of the input
};

/// Mean and largest residual of the frames, of the whole face and by region: a table on standard output, or a
/// JSON object on one line.
void print_fit(const std::filesystem::path& input, const std::filesystem::path& output,
               const FitOutcome& outcome, bool json);

/// The residuals of every frame as CSV: its header, and the rows of a sequence.
std::string residual_header(const FitOutcome& outcome);
std::string residual_rows(const std::string& sequence, const FitOutcome& outcome);

}  // namespace mien
