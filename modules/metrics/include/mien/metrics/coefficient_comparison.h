#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mien/core/motion.h"
#include "mien/metrics/wind.h"

namespace mien {

/// Features of the windows that begin at frames 0 ... num_windows - 1 of a motion, [num_windows, d].
using WindowFeatures = std::function<FeatureTable(const Motion& motion, std::int64_t num_windows)>;

/// Distances between the windows of generated and of recorded sequences.
struct MotionDistances {
  std::int64_t num_generated = 0, num_true = 0;  ///< windows
  double fd = 0;                                 ///< frechet_distance() of all windows
  WindScore wind;
  double multimodality = 0;
  std::int64_t num_pairs = 0;  ///< of windows that multimodality compares
};

/// SAiD's protocol (specification, section 8.2): windows begin at every frame. Of a recorded sequence the
/// last two windows are left out, because generated ones can be up to two frames shorter; generated windows
/// count when the recorded sequence of the same person and sentence has a window there. Figures that are not
/// defined are NaN.
class CoefficientComparison {
 public:
  /// @param window  frames
  CoefficientComparison(std::int64_t window, WindowFeatures features)
      : window_(window), features_(std::move(features)) {}

  /// @pre each person's sentence once
  void add_truth(const std::string& person, int sentence, const Motion& motion);
  /// The next repetition; false when there is no truth of that person's sentence, and it is left out. @pre
  /// all truth was added
  bool add_generated(const std::string& person, int sentence, const Motion& motion);
  [[nodiscard]] MotionDistances distances(const WindOptions& options) const;

 private:
  using Key = std::pair<std::string, int>;
  std::int64_t window_;
  WindowFeatures features_;
  FeatureTable truth_;
  std::map<Key, std::int64_t> num_true_;
  std::map<Key, std::vector<FeatureTable>> generated_;  // repetitions
};

}  // namespace mien
