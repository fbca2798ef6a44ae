#include "mien/io/coefficient_csv.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>

#include "even_motion.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "shape_names.h"

namespace mien {
namespace {

// A float32 as numpy prints it: decimal from 1e-4 on and below 1e16, always with a dot, else with an
// exponent.
std::string numpy_text(float value) {
  if (value == 0) return std::signbit(value) ? "-0.0" : "0.0";
  char buffer[64];
  const auto written = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::scientific);
  std::string_view text(buffer, static_cast<std::size_t>(written.ptr - buffer));
  std::string out;
  if (text.front() == '-') {
    out = "-";
    text.remove_prefix(1);
  }
  const auto e = text.find('e');
  const int exponent = std::atoi(std::string(text.substr(e + 1)).c_str());
  if (exponent < -4 || exponent >= 16) return out + std::string(text);
  std::string digits(text.substr(0, e));
  std::erase(digits, '.');
  if (exponent < 0) return out + "0." + std::string(static_cast<std::size_t>(-exponent - 1), '0') + digits;
  const auto whole = static_cast<std::size_t>(exponent) + 1;
  if (digits.size() < whole) digits.append(whole - digits.size(), '0');
  if (digits.size() == whole) digits += '0';
  return out + digits.substr(0, whole) + "." + digits.substr(whole);
}

}  // namespace

Status write_coefficient_csv(const Motion& motion, const TextSink& sink) {
  if (motion.space != MotionSpace::arkit)
    return Error{Errc::incompatible, "coefficient CSV", "the motion is not made of ARKit coefficients", ""};
  MIEN_TRY([[maybe_unused]] const auto checked, io::check_motion(motion, "coefficient CSV"));
  std::vector<std::optional<std::int64_t>> columns;
  std::vector<bool> used(motion.channels.size());
  std::string line;
  for (const std::string& name : arkit_order(ArkitOrder::said)) {
    columns.push_back(motion.find(name));
    if (columns.back()) used[static_cast<std::size_t>(*columns.back())] = true;
    line += (line.empty() ? "" : ",") + name;
  }
  MIEN_TRY([[maybe_unused]] const auto header, sink(line + "\n"));
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    line.clear();
    for (const auto& column : columns) {
      if (!line.empty()) line += ',';
      line += column ? numpy_text(motion.frame(n)[static_cast<std::size_t>(*column)]) : "0.0";
    }
    MIEN_TRY([[maybe_unused]] const auto row, sink(line + "\n"));
  }
  constexpr double kFps = 60;
  Status status{Done{}};
  std::vector<std::string> lost;
  for (std::size_t c = 0; c < used.size(); ++c)
    if (!used[c]) lost.push_back(motion.channels[c]);
  if (!lost.empty())
    status.warnings.push_back("channels that SAiD's CSV has no column for: " + io::listed(lost));
  if (motion.fps != kFps)
    status.warnings.push_back(
        "SAiD's CSV states no rate and is taken for 60 frames a second; the motion has " +
        fixed(motion.fps, 2));
  return status;
}

}  // namespace mien
