#pragma once
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/io/safetensors.h"
#include "mien/motion/kept_values.h"

namespace CLI {
class App;
}

namespace mien {

/// The words of the command line that say what an edit keeps.
struct KeepWords {
  std::vector<std::string> ranges;  ///< stretches to make anew: "1.20-2.05"
  std::vector<std::string> locks;   ///< channels to keep: "jawOpen", "mouthSmile*"
  std::string mask, keys;           ///< files
};

/// --range, --lock, --mask and --keep-keys.
void add_keep_options(CLI::App& command, KeepWords& words);

/// What they keep of a motion. Of vertices, --lock names regions of the model file, or files with indices of
/// vertices. Errors: Errc::usage for words that say nothing, keep everything, or do not fit
/// the motion; Errc::input for broken files; Errc::incompatible for files that do not fit the motion.
/// Warnings: channels that a mask does not name, which are kept.
Result<KeptValues> kept_values(const KeepWords& words, const Motion& motion, const SafetensorsFile& model);

}  // namespace mien
