#include "mien/metrics/mean_of.h"

#include <limits>

namespace mien {

MeanOf& MeanOf::operator+=(const MeanOf& other) {
  sum += other.sum;
  count += other.count;
  return *this;
}

double MeanOf::value() const {
  return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace mien
