#include "mien/metrics/vertex_regions.h"

#include <algorithm>
#include <cmath>

#include "mien/base/number_text.h"

namespace mien {

Result<std::vector<std::uint32_t>> read_region(std::string_view text, std::int64_t num_vertices,
                                               double weight_above) {
  constexpr std::string_view kSeparators = ", \t\r\n";
  std::vector<double> numbers;
  bool has_dot = false;
  for (std::size_t at = text.find_first_not_of(kSeparators); at != std::string_view::npos;
       at = text.find_first_not_of(kSeparators, at)) {
    const auto end = std::min(text.find_first_of(kSeparators, at), text.size());
    const auto word = text.substr(at, end - at);
    const auto number = parse_double(word);
    if (!number || !std::isfinite(*number))
      return Error{Errc::input, "region", "'" + std::string(word.substr(0, 40)) + "' is no number", ""};
    has_dot = has_dot || word.find_first_of(".e") != std::string_view::npos;
    numbers.push_back(*number);
    at = end;
  }
  const bool is_weights = has_dot && static_cast<std::int64_t>(numbers.size()) == num_vertices;
  std::vector<std::uint32_t> vertices;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (is_weights) {
      if (numbers[i] > weight_above) vertices.push_back(static_cast<std::uint32_t>(i));
      continue;
    }
    if (numbers[i] != std::floor(numbers[i]) || !(numbers[i] >= 0) ||
        !(numbers[i] < static_cast<double>(num_vertices)))
      return Error{Errc::incompatible, "region",
                   "number " + std::to_string(i + 1) + " is no vertex of " + std::to_string(num_vertices) +
                       ", and there are " + std::to_string(numbers.size()) +
                       " numbers, not one weight per vertex",
                   "Use the region file of the motion's data set"};
    vertices.push_back(static_cast<std::uint32_t>(numbers[i]));
  }
  return vertices;
}

}  // namespace mien
