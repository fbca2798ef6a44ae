#include "mien/metrics/distribution.h"

#include <cmath>
#include <limits>

#include "mien/base/contract.h"

namespace mien {
namespace {

void require_equal_shape(std::span<const Motion> takes) {
  for (const Motion& take : takes) {
    require_performance(take);
    contract(take.values.size() == takes.front().values.size(),
             "metrics: takes of one recording differ in length");
  }
}

double excess(double error, double floor) { return (error - floor) / floor; }

}  // namespace

MeanOf pair_distance(std::span<const Motion> takes, FaceRegion region) {
  MeanOf out;
  if (takes.size() < 2) return out;
  require_equal_shape(takes);
  const auto channels = region_channels(region);
  const std::int64_t num_frames = takes.front().num_frames();
  for (std::int64_t n = 0; n < num_frames; ++n) {
    double sum = 0;
    for (std::size_t i = 0; i < takes.size(); ++i) {
      const auto a = takes[i].frame(n);
      for (std::size_t j = i + 1; j < takes.size(); ++j) {
        const auto b = takes[j].frame(n);
        for (const std::size_t c : channels) sum += std::abs(static_cast<double>(a[c]) - b[c]);
      }
    }
    const double pairs = static_cast<double>(takes.size()) * static_cast<double>(takes.size() - 1) / 2;
    out.add(sum / pairs / static_cast<double>(channels.size()));
  }
  return out;
}

MeanOf second_difference(std::span<const Motion> takes, FaceRegion region) {
  MeanOf out;
  for (const Motion& take : takes) {
    require_performance(take);
    for (std::int64_t n = 1; n + 1 < take.num_frames(); ++n) {
      const auto before = take.frame(n - 1), at = take.frame(n), after = take.frame(n + 1);
      double sum = 0;
      for (const std::size_t c : region_channels(region))
        sum += std::abs(static_cast<double>(after[c]) - 2.0 * at[c] + before[c]);
      out.add(sum / static_cast<double>(region_channels(region).size()));
    }
  }
  return out;
}

AccuracyScore& AccuracyScore::operator+=(const AccuracyScore& other) {
  absolute += other.absolute;
  squared += other.squared;
  floor_absolute += other.floor_absolute;
  floor_squared += other.floor_squared;
  return *this;
}

double AccuracyScore::excess_mae() const { return excess(absolute.value(), floor_absolute.value()); }
double AccuracyScore::excess_rmse() const {
  return excess(std::sqrt(squared.value()), std::sqrt(floor_squared.value()));
}

AccuracyScore score_accuracy(const Motion& prediction, const Motion& conditional_mean, const Motion& held_out,
                             FaceRegion region) {
  const Motion* const motions[] = {&prediction, &conditional_mean, &held_out};
  for (const Motion* motion : motions) {
    require_performance(*motion);
    contract(motion->values.size() == held_out.values.size(), "score_accuracy: the motions differ in length");
  }
  AccuracyScore out;
  for (std::int64_t n = 0; n < held_out.num_frames(); ++n) {
    for (const std::size_t c : region_channels(region)) {
      const double y = held_out.frame(n)[c];
      const double error = prediction.frame(n)[c] - y, floor = conditional_mean.frame(n)[c] - y;
      out.absolute.add(std::abs(error));
      out.squared.add(error * error);
      out.floor_absolute.add(std::abs(floor));
      out.floor_squared.add(floor * floor);
    }
  }
  return out;
}

}  // namespace mien
