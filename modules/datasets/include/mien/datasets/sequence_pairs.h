#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mien/base/result.h"

namespace mien {

/// How a prediction's file name tells its sequence (FaceDiffuser specification, sections 9 and 13).
enum class PairRule {
  vertices,  ///< <sequence>, or <sequence>_condition_<subject>, with _1 ... _k for several samples
  beat,      ///< the first three fields between underscores
  uudamm,    ///< the first two
};

struct PredictedSequence {
  std::string sequence, subject;  ///< subject: the sequence up to its last underscore
  std::string condition;          ///< whose style; empty: the name does not say
  std::filesystem::path predicted, truth;
};

struct PairedSequences {
  /// What is compared with the truth: predictions in the style of their own subject, or of none that the name
  /// tells.
  std::vector<PredictedSequence> pairs;
  /// For diversity: predictions of subjects that lend none of them their style, by sequence; two or more
  /// each.
  std::map<std::string, std::vector<std::filesystem::path>> takes;
  std::vector<std::string> without_truth, without_prediction;  ///< names
};

/// Pairs two folders (or two files). Only .npy, .csv and .json files count. Errors (Errc::input): a folder
/// that cannot be listed, nothing that pairs.
Result<PairedSequences> pair_sequences(const std::filesystem::path& predicted,
                                       const std::filesystem::path& truth, PairRule rule);

}  // namespace mien
