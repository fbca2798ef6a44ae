#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/core/motion.h"

namespace mien {

/// Does a generated take show the emotion, level and style that were asked for? A nearest-centroid classifier
/// trained on true takes judges (corpus specification, section 13); its accuracy on other true takes is the
/// ceiling.

/// What the classifier sees: mean and standard deviation over the clip of the 52 curves (head angles left
/// out). [104] Zeros for a motion without frames. @pre a performance
std::vector<double> condition_features(const Motion& motion);

/// One labelled clip. `context` names what is known beforehand: only labels seen in that context compete (0
/// throughout when nothing is known; the emotion when levels are told apart).
struct ConditionExample {
  std::vector<double> features;
  int label = 0;
  int context = 0;
  int variety = 0;  ///< a label may have several centroids: an emotion has one per level
};

class CentroidClassifier {
 public:
  /// Averages the examples per context, label and variety, and divides every feature by its standard
  /// deviation inside these groups (at least 1e-3): features that vary for other reasons than the label count
  /// less.
  /// @pre features of equal length
  explicit CentroidClassifier(std::span<const ConditionExample> examples);

  /// Label of the nearest centroid of `context`; -1 when that context was never seen.
  [[nodiscard]] int predict(std::span<const double> features, int context) const;
  /// Labels that compete in a context: with fewer than two there is nothing to classify.
  [[nodiscard]] std::size_t num_labels(int context) const;

 private:
  struct Centroid {
    int context, label, variety;
    std::vector<double> values;
  };
  std::vector<double> scale_;  // 1 / standard deviation
  std::vector<Centroid> centroids_;
};

/// Right answers out of all; pools with +=.
struct FidelityCounts {
  std::int64_t right = 0, total = 0;

  FidelityCounts& operator+=(const FidelityCounts& other);
  [[nodiscard]] double accuracy() const;  ///< NaN when nothing was judged
};

/// Judges examples by their own label and context; those of a context with fewer than two labels are left
/// out.
FidelityCounts judge(const CentroidClassifier& classifier, std::span<const ConditionExample> examples);

}  // namespace mien
