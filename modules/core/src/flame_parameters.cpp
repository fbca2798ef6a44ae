#include "mien/core/flame_parameters.h"

#include <array>
#include <charconv>

#include "mien/base/contract.h"

namespace mien {
namespace {

constexpr std::string_view kShape = "shape_", kExpression = "expression_";
constexpr std::array<std::string_view, kNumFlameJaw> kJaw = {"jaw_x", "jaw_y", "jaw_z"};

// The number behind a prefix, when it is below the limit and written without leading zeros.
std::optional<std::size_t> number_behind(std::string_view name, std::string_view prefix, std::size_t limit) {
  if (!name.starts_with(prefix)) return std::nullopt;
  const std::string_view digits = name.substr(prefix.size());
  std::size_t number = 0;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (problem != std::errc() || end != digits.data() + digits.size() || number >= limit) return std::nullopt;
  if (digits.size() > 1 && digits.front() == '0') return std::nullopt;
  return number;
}

}  // namespace

std::vector<std::string> flame_channels(std::size_t num_shape, std::size_t num_expression) {
  contract(num_shape <= kNumFlameShape && num_expression <= kNumFlameExpression,
           "flame_channels: FLAME has fewer parameters");
  std::vector<std::string> names;
  for (std::size_t i = 0; i < num_shape; ++i) names.push_back(std::string(kShape) + std::to_string(i));
  for (std::size_t i = 0; i < num_expression; ++i)
    names.push_back(std::string(kExpression) + std::to_string(i));
  names.insert(names.end(), kJaw.begin(), kJaw.end());
  return names;
}

std::optional<std::size_t> flame_column(std::string_view channel) {
  if (const auto shape = number_behind(channel, kShape, kNumFlameShape)) return shape;
  if (const auto expression = number_behind(channel, kExpression, kNumFlameExpression))
    return kNumFlameShape + *expression;
  for (std::size_t i = 0; i < kJaw.size(); ++i)
    if (channel == kJaw[i]) return kNumFlameShape + kNumFlameExpression + i;
  return std::nullopt;
}

std::vector<std::optional<std::size_t>> flame_columns(const Motion& motion) {
  contract(motion.space == MotionSpace::flame, "flame_columns: the motion is not made of FLAME parameters");
  std::vector<std::optional<std::size_t>> columns;
  for (const auto& channel : motion.channels) columns.push_back(flame_column(channel));
  return columns;
}

}  // namespace mien
