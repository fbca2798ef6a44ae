#include "closeness.h"

#include <cmath>
#include <limits>

namespace mien::parity {
namespace {

std::vector<double> widened(const Tensor& x) { return {x.values().begin(), x.values().end()}; }

std::string index_text(std::size_t index, const Shape& shape) {
  std::string text;
  auto rest = static_cast<std::int64_t>(index);
  for (std::size_t axis = shape.size(); axis-- > 0; rest /= shape[axis])
    text = std::to_string(rest % shape[axis]) + (text.empty() ? "" : ", ") + text;
  return "(" + (shape.empty() ? std::to_string(index) : text) + ")";
}

double distance(double got, double want) {
  const double d = std::abs(got - want);
  return std::isnan(d) && !(got == want) ? std::numeric_limits<double>::infinity() : d;
}

}  // namespace

std::string differences(std::span<const double> got, std::span<const double> want, const Tolerance& tolerance,
                        const Shape& shape) {
  const std::string stage(tolerance.stage);
  if (got.size() != want.size())
    return stage + ": " + std::to_string(got.size()) + " values, recorded are " + std::to_string(want.size());
  std::size_t count = 0, worst = 0;
  double largest = -1;
  for (std::size_t i = 0; i < want.size(); ++i) {
    if (got[i] == want[i]) continue;  // also equal infinities
    const double d = distance(got[i], want[i]);
    if (d <= tolerance.absolute + tolerance.relative * std::abs(want[i])) continue;
    ++count;
    if (d > largest) {
      largest = d;
      worst = i;
    }
  }
  if (count == 0) return "";
  return stage + ": " + std::to_string(count) + " of " + std::to_string(want.size()) +
         " values differ, the worst at " + index_text(worst, shape) + ": " + std::to_string(got[worst]) +
         " instead of " + std::to_string(want[worst]) + ", by " + std::to_string(largest * 1e6) + "e-6";
}

std::string differences(const Tensor& got, const Tensor& want, const Tolerance& tolerance) {
  return differences(widened(got), widened(want), tolerance, want.shape());
}

double largest_difference(const Tensor& got, const Tensor& want) {
  if (got.count() != want.count()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (std::size_t i = 0; i < got.values().size(); ++i)
    largest = std::max(largest, distance(got.values()[i], want.values()[i]));
  return largest;
}

}  // namespace mien::parity
