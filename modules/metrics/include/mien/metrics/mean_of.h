#pragma once
#include <cstdint>

namespace mien {

/// Sum and count: a mean that can be pooled with +=.
struct MeanOf {
  double sum = 0;
  std::int64_t count = 0;

  void add(double value) { sum += value, ++count; }
  MeanOf& operator+=(const MeanOf& other);
  /// NaN when nothing was added.
  [[nodiscard]] double value() const;
};

}  // namespace mien
