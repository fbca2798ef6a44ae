#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mien {

/// Decimal text <-> numbers, independent of the locale. The whole text must be the number (no spaces).
std::optional<double> parse_double(std::string_view text);
std::optional<std::int64_t> parse_int(std::string_view text);

/// Fixed notation with `decimals` digits after the dot: fixed(1.5, 3) == "1.500".
std::string fixed(double value, int decimals);
/// Shortest text that reads back as the same float.
std::string shortest(float value);

}  // namespace mien
