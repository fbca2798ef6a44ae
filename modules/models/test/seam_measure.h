#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "mien/core/motion.h"

namespace mien {

/// How rough joins are: accelerations of some channels together, in units of what is usual in a clip.
class SeamMeasure {
 public:
  SeamMeasure(const Motion& motion, std::vector<std::size_t> channels)
      : motion_(motion), channels_(std::move(channels)) {
    std::vector<double> all;
    for (std::int64_t n = 1; n + 1 < motion.num_frames(); ++n) all.push_back(acceleration(motion, n));
    usual_ = percentile(all, 0.95);
  }
  /// The 95th percentile of the clip's own.
  [[nodiscard]] double usual() const { return usual_; }
  /// Of the frames that the new motion has a part in and the old one too. A join beside what is rough in the
  /// old motion cannot be smoother than that.
  void add(const Motion& take, FrameRange stretch) {
    for (const std::int64_t n : {stretch.first - 1, stretch.first, stretch.end - 1, stretch.end})
      ratios_.push_back(ratio_at(take, n));
    constexpr std::int64_t kBehind = 7;
    const std::int64_t reach = std::min(kBehind, (stretch.end - stretch.first) / 2 - 1);
    for (std::int64_t i = 1; i <= reach; ++i)
      for (const std::int64_t n : {stretch.first + i, stretch.end - 1 - i})
        behind_.push_back(ratio_at(take, n));
  }
  /// The same of the seven frames behind each join: what is taken from a join must not come back there.
  [[nodiscard]] std::ptrdiff_t num_above_behind() const { return count_above(behind_); }
  [[nodiscard]] std::ptrdiff_t size_behind() const { return std::ssize(behind_); }
  [[nodiscard]] double ratio(double share) const { return percentile(ratios_, share); }
  [[nodiscard]] std::ptrdiff_t num_above() const { return count_above(ratios_); }
  [[nodiscard]] std::ptrdiff_t size() const { return std::ssize(ratios_); }

 private:
  static std::ptrdiff_t count_above(const std::vector<double>& ratios) {
    return std::count_if(ratios.begin(), ratios.end(), [](double r) { return r > 1; });
  }
  // The resolution of float32 counts as still.
  [[nodiscard]] double ratio_at(const Motion& take, std::int64_t n) const {
    constexpr double kStill = 1e-6;
    return acceleration(take, n) / std::max({usual_, acceleration(motion_, n), kStill});
  }
  static double percentile(std::vector<double> values, double share) {
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
  }
  /// Length of the second difference of the channels at frame n.
  [[nodiscard]] double acceleration(const Motion& motion, std::int64_t n) const {
    double sum = 0;
    for (const std::size_t c : channels_) {
      const double a = static_cast<double>(motion.frame(n - 1)[c]) -
                       2 * static_cast<double>(motion.frame(n)[c]) +
                       static_cast<double>(motion.frame(n + 1)[c]);
      sum += a * a;
    }
    return std::sqrt(sum);
  }

  const Motion& motion_;
  std::vector<std::size_t> channels_;
  double usual_ = 0;
  std::vector<double> ratios_, behind_;
};

}  // namespace mien
