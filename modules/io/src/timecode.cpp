#include "timecode.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mien/base/number_text.h"

namespace mien::io {
namespace {

constexpr std::array kTimecodeRates = {24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 90.0, 100.0, 120.0, 240.0};

std::string two_digits(std::int64_t value) { return (value < 10 ? "0" : "") + std::to_string(value); }

}  // namespace

std::optional<Timecode> parse_timecode(std::string_view text) {
  std::array<double, 4> parts{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto end = i < 3 ? text.find_first_of(":;") : text.size();
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view part = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto value = parse_double(part);
    if (!value || !(*value >= 0) || *value >= 1e4) return std::nullopt;
    if (i < 3 && *value != std::floor(*value)) return std::nullopt;
    parts[i] = *value;
  }
  return Timecode{3600 * parts[0] + 60 * parts[1] + parts[2], parts[3]};
}

std::string timecode_text(std::int64_t n, double fps) {
  const double time = static_cast<double>(n) / fps;
  auto seconds = static_cast<std::int64_t>(time + 1e-9);
  // Thousandths of a frame since the full second; rounding up to the next second carries.
  auto thousandths =
      std::max<std::int64_t>(0, std::llround((time - static_cast<double>(seconds)) * fps * 1000));
  if (static_cast<double>(thousandths) >= fps * 1000 - 0.5) {
    ++seconds;
    thousandths = 0;
  }
  const std::string fraction = std::to_string(thousandths % 1000);
  return two_digits(seconds / 3600 % 24) + ":" + two_digits(seconds / 60 % 60) + ":" +
         two_digits(seconds % 60) + ":" + two_digits(thousandths / 1000) + "." +
         std::string(3 - fraction.size(), '0') + fraction;
}

double timecode_rate(const std::vector<Timecode>& rows) {
  double largest = 0;
  bool wraps = false;
  for (const Timecode& row : rows) {
    largest = std::max(largest, row.frames);
    wraps = wraps || row.whole_seconds != rows.front().whole_seconds;
  }
  const double at_least = std::floor(largest) + 1;
  if (!wraps && at_least <= 60) return 60;
  for (const double rate : kTimecodeRates)
    if (rate >= at_least) return rate;
  return at_least;
}

bool can_count_at(double fps, const std::vector<Timecode>& rows) {
  return std::all_of(rows.begin(), rows.end(),
                     [&](const Timecode& row) { return row.frames < std::ceil(fps); });
}

double usual_rate(double fps) {
  constexpr double kTolerance = 5e-4;
  for (const double rate : {24000.0 / 1001, 30000.0 / 1001, 60000.0 / 1001, std::round(fps)})
    if (rate > 0 && std::abs(fps - rate) <= kTolerance * rate) return rate;
  return fps;
}

}  // namespace mien::io
