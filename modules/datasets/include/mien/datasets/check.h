#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/datasets/dataset.h"

namespace mien {

/// Sequences of one split, found against what the full data set has.
struct SplitCount {
  std::string split;
  std::int64_t found = 0, expected = 0;  ///< expected 0: not stated
  std::int64_t num_frames = 0;           ///< of the stored motion
};

struct DatasetReport {
  std::vector<SplitCount> splits;  ///< train, val, test, and "none" where some sequences belong to no split
  std::vector<std::string> problems;  ///< training or evaluation would fail
  std::vector<std::string> oddities;  ///< it would work, but perhaps not mean what it should
};

struct DatasetCheckOptions {
  bool read_values = false;  ///< look at every number of every motion: minutes for the large data sets
  int most_named = 5;        ///< names that a finding lists before it counts the rest
};

/// What is missing or odd: sequences without their partner, names of another data set, subjects without
/// template or of another size, arrays that differ in width or are not float32, motion that is longer or
/// shorter than its sound by more than half a second, numbers that are not finite, splits that are empty or
/// incomplete. Errors: Errc::cancelled. Files that cannot be read are problems, not errors.
Result<DatasetReport> check_dataset(const Dataset& dataset, const DatasetCheckOptions& options,
                                    Progress& progress);

}  // namespace mien
