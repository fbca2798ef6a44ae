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
  beat,      ///< the first three fields between underscores, with "(n)" or "-n" for several takes
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

/// Predictions of one true sequence, in the order of their numbers.
struct SequenceTakes {
  std::string sequence;
  std::filesystem::path truth;
  std::vector<std::filesystem::path> takes;
};
struct PairedTakes {
  std::vector<SequenceTakes> sequences;
  std::vector<std::string> without_truth, without_prediction;  ///< names
};

/// Pairs two folders whose predictions come in several takes: a file is called <truth>, or <truth>_ and more
/// (as ProbTalk3D's programs add identity, emotion and intensity), with "(n)" or "-n" at its end. The longest
/// name of a truth that fits counts. Errors as pair_sequences().
Result<PairedTakes> pair_takes(const std::filesystem::path& predicted, const std::filesystem::path& truth);

}  // namespace mien
