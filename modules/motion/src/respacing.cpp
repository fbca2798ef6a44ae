#include <charconv>
#include <cmath>
#include <string>

#include "mien/base/contract.h"
#include "mien/motion/diffusion_process.h"

namespace mien {
namespace {

std::optional<std::int64_t> parse_count(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size() || value < 1) return std::nullopt;
  return value;
}

Error refuse(std::string_view rule, const std::string& why) {
  return {Errc::usage, "respacing '" + std::string(rule) + "'", why,
          "Use ddim and a number of steps (ddim50), or counts for equal sections (10,15,20)"};
}

// std::nearbyint follows the rounding mode of the thread; this does not.
std::int64_t round_half_even(double value) {
  const double below = std::floor(value), rest = value - below;
  const auto whole = static_cast<std::int64_t>(below);
  if (rest != 0.5) return rest < 0.5 ? whole : whole + 1;
  return whole % 2 == 0 ? whole : whole + 1;
}

Result<std::vector<std::int64_t>> every_nth(std::string_view rule, std::int64_t wanted, std::int64_t total) {
  for (std::int64_t stride = 1; stride <= total; ++stride) {
    if ((total + stride - 1) / stride != wanted) continue;
    std::vector<std::int64_t> kept;
    for (std::int64_t i = 0; i < total; i += stride) kept.push_back(i);
    return kept;
  }
  return refuse(
      rule, "no whole stride takes " + std::to_string(wanted) + " of " + std::to_string(total) + " steps");
}

}  // namespace

Result<std::vector<std::int64_t>> respaced_steps(std::string_view rule, std::int64_t num_steps) {
  contract(num_steps >= 1, "respaced_steps: at least one step is needed");
  if (rule.empty()) return every_nth(rule, num_steps, num_steps);
  if (rule.starts_with("ddim")) {
    const auto wanted = parse_count(rule.substr(4));
    if (!wanted) return refuse(rule, "'" + std::string(rule.substr(4)) + "' is not a number of steps");
    return every_nth(rule, *wanted, num_steps);
  }
  std::vector<std::int64_t> counts;
  for (std::string_view rest = rule;;) {
    const std::size_t comma = rest.find(',');
    const auto count = parse_count(rest.substr(0, comma));
    if (!count) return refuse(rule, "'" + std::string(rest.substr(0, comma)) + "' is not a number of steps");
    counts.push_back(*count);
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  const auto num_sections = static_cast<std::int64_t>(counts.size());
  std::vector<std::int64_t> kept;
  std::int64_t start = 0;
  for (std::int64_t s = 0; s < num_sections; ++s) {
    const std::int64_t length = num_steps / num_sections + (s < num_steps % num_sections ? 1 : 0);
    const std::int64_t count = counts[static_cast<std::size_t>(s)];
    if (count > length)
      return refuse(rule,
                    std::to_string(count) + " steps do not fit into a section of " + std::to_string(length));
    const double stride = count == 1 ? 1.0 : static_cast<double>(length - 1) / static_cast<double>(count - 1);
    double at = 0;  // summed up, not multiplied: the published rule, to the last rounding
    for (std::int64_t j = 0; j < count; ++j, at += stride) kept.push_back(start + round_half_even(at));
    start += length;
  }
  return kept;
}

}  // namespace mien
