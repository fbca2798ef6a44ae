#pragma once
#include <string>

#include "mien/base/result.h"
#include "mien/models/default/stream.h"

namespace mien {

/// The words of the command line that direct a performance.
struct DirectionWords {
  std::string emotion;  ///< "angry:2", or a file with keys over time; empty: neutral
  std::string style;    ///< "S05"; empty: no one in particular
  std::string sampler = "dpm++";
  int steps = 8;
  std::uint64_t seed = 0;
};

/// Errors: Errc::usage for unknown words, Errc::input for a broken direction file.
Result<PerformOptions> perform_options(const DirectionWords& words);

}  // namespace mien
