#include "mien/models/probtalk3d/codes.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"

namespace mien::probtalk3d {
namespace {

std::int64_t num_chunks(std::span<const float> table, std::int64_t num_codes) {
  contract(num_codes > 0 && static_cast<std::int64_t>(table.size()) % num_codes == 0,
           "codes: the table is not whole rows");
  return static_cast<std::int64_t>(table.size()) / num_codes;
}

std::span<const float> row_of(std::span<const float> table, std::int64_t row, std::int64_t num_codes) {
  return table.subspan(static_cast<std::size_t>(row * num_codes), static_cast<std::size_t>(num_codes));
}

}  // namespace

std::vector<std::int64_t> nearest_codes(std::span<const float> distances, std::int64_t num_codes) {
  std::vector<std::int64_t> codes;
  for (std::int64_t n = 0; n < num_chunks(distances, num_codes); ++n) {
    const auto row = row_of(distances, n, num_codes);
    codes.push_back(std::min_element(row.begin(), row.end()) - row.begin());
  }
  return codes;
}

std::vector<float> code_probabilities(std::span<const float> distances, std::int64_t num_codes,
                                      double temperature) {
  contract(temperature > 0, "code_probabilities: the temperature must be above 0");
  std::vector<float> probabilities(distances.size());
  for (std::int64_t n = 0; n < num_chunks(distances, num_codes); ++n) {
    const auto row = row_of(distances, n, num_codes);
    const float nearest = *std::min_element(row.begin(), row.end());
    float* out = probabilities.data() + n * num_codes;
    double sum = 0;
    for (std::size_t j = 0; j < row.size(); ++j) {
      const double behind = static_cast<double>(row[j]) - static_cast<double>(nearest);
      out[j] = static_cast<float>(std::exp(-behind / temperature));
      sum += out[j];
    }
    for (std::size_t j = 0; j < row.size(); ++j) out[j] = static_cast<float>(out[j] / sum);
  }
  return probabilities;
}

std::vector<std::int64_t> draw_codes(std::span<const float> probabilities, std::int64_t num_codes, int place,
                                     const CodeRace& race) {
  contract(place >= 1, "draw_codes: places count from 1");
  std::vector<std::int64_t> codes;
  std::vector<float> times(static_cast<std::size_t>(std::max<std::int64_t>(num_codes, 0)));
  std::vector<std::int64_t> order(times.size());
  for (std::int64_t n = 0; n < num_chunks(probabilities, num_codes); ++n) {
    const auto row = row_of(probabilities, n, num_codes);
    race(n, times);
    order.clear();
    for (std::size_t j = 0; j < row.size(); ++j) {
      times[j] = row[j] / times[j];
      if (row[j] > 0) order.push_back(static_cast<std::int64_t>(j));
    }
    if (order.empty()) order.push_back(0);  // only when distances are not finite
    const auto k = std::min<std::size_t>(static_cast<std::size_t>(place), order.size()) - 1;
    const auto faster = [&](std::int64_t a, std::int64_t b) {
      const float left = times[static_cast<std::size_t>(a)], right = times[static_cast<std::size_t>(b)];
      return left > right || (left == right && a < b);
    };
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(k), order.end(), faster);
    codes.push_back(order[k]);
  }
  return codes;
}

}  // namespace mien::probtalk3d
