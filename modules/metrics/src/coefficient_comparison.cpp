#include "mien/metrics/coefficient_comparison.h"

#include <algorithm>

#include "mien/base/contract.h"
#include "mien/metrics/multimodality.h"
#include "undefined.h"

namespace mien {
namespace {

constexpr std::int64_t kLeftOut = 2;  // windows at the end of a recorded sequence

void append(FeatureTable& table, const FeatureTable& more) {
  contract(table.values.empty() || table.width == more.width,
           "CoefficientComparison: features of another width");
  table.width = more.width;
  table.values.insert(table.values.end(), more.values.begin(), more.values.end());
}

}  // namespace

void CoefficientComparison::add_truth(const std::string& person, int sentence, const Motion& motion) {
  const std::int64_t count = std::max<std::int64_t>(0, motion.num_frames() - window_ + 1 - kLeftOut);
  const bool is_new = num_true_.emplace(Key{person, sentence}, count).second;
  contract(is_new, "CoefficientComparison: a sentence was added twice");
  if (count > 0) append(truth_, features_(motion, count));
}

bool CoefficientComparison::add_generated(const std::string& person, int sentence, const Motion& motion) {
  const auto known = num_true_.find({person, sentence});
  if (known == num_true_.end()) return false;
  const std::int64_t count = std::min(known->second, motion.num_frames() - window_ + 1);
  if (count > 0) generated_[known->first].push_back(features_(motion, count));
  return true;
}

MotionDistances CoefficientComparison::distances(const WindOptions& options) const {
  FeatureTable all;
  Multimodality spread;
  for (const auto& [key, repetitions] : generated_) {
    std::int64_t longest = 0;
    for (const auto& table : repetitions) append(all, table), longest = std::max(longest, table.num_rows());
    for (std::int64_t start = 0; start < longest; ++start) {
      FeatureTable group{repetitions.front().width, {}};
      for (const auto& table : repetitions) {
        if (start >= table.num_rows()) continue;
        const auto row = table.row(start);
        group.values.insert(group.values.end(), row.begin(), row.end());
      }
      spread.add_group(group);
    }
  }
  MotionDistances result{all.num_rows(), truth_.num_rows(), kNan,
                         {kNan, kNan},   spread.value(),    spread.num_pairs()};
  if (result.num_generated < 2 || result.num_true < 2) return result;
  result.fd = frechet_distance(gaussian_of(all), gaussian_of(truth_));
  result.wind = wind(all, truth_, options);
  return result;
}

}  // namespace mien
