#include "mien/metrics/multimodality.h"

#include <cmath>

#include "mien/base/contract.h"
#include "undefined.h"

namespace mien {
namespace {

double distance(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

}  // namespace

void Multimodality::add_group(const FeatureTable& repetitions) {
  const std::int64_t half = repetitions.num_rows() / 2;
  for (std::int64_t i = 0; i < half; ++i) sum_ += distance(repetitions.row(i), repetitions.row(half + i));
  num_pairs_ += half;
}

void Multimodality::add_pairs(const FeatureTable& a, const FeatureTable& b) {
  contract(a.width == b.width && a.num_rows() == b.num_rows(), "add_pairs: tables of different sizes");
  for (std::int64_t i = 0; i < a.num_rows(); ++i) sum_ += distance(a.row(i), b.row(i));
  num_pairs_ += a.num_rows();
}

double Multimodality::value() const {
  return num_pairs_ == 0 ? kNan : sum_ / static_cast<double>(num_pairs_);
}

}  // namespace mien
