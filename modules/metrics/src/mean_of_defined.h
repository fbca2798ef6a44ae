#pragma once
#include <cmath>
#include <vector>

#include "mien/metrics/mean_of.h"

namespace mien {

/// Mean of value(sequence) over the sequences for which it is defined; NaN when it is for none.
template <class Sequence, class Value>
double mean_of_defined(const std::vector<Sequence>& sequences, Value value) {
  MeanOf mean;
  for (const Sequence& sequence : sequences)
    if (const double x = value(sequence); !std::isnan(x)) mean.add(x);
  return mean.value();
}

}  // namespace mien
