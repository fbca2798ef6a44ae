#include "mien/metrics/mean_of.h"

#include "undefined.h"

namespace mien {

MeanOf& MeanOf::operator+=(const MeanOf& other) {
  sum += other.sum;
  count += other.count;
  return *this;
}

double MeanOf::value() const { return count > 0 ? sum / static_cast<double>(count) : kNan; }

}  // namespace mien
