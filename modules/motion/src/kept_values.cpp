#include "mien/motion/kept_values.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"

namespace mien {
namespace {

constexpr double kSameInstant =
    1e-6;  // seconds: 1.2 is the instant of frame 72 at 60 fps, whatever double says

// Whether the whole name matches. Linear in the length of both for one star, as the last star alone is
// retried.
bool matches(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0, after_star = std::string_view::npos, retry = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      after_star = ++p;
      retry = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (after_star != std::string_view::npos) {
      p = after_star;
      n = ++retry;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

}  // namespace

Result<FrameRange> frames_of_range(std::string_view text, const Motion& motion) {
  const auto fail = [&](std::string why, std::string fix = "") {
    return Error{Errc::usage, "range '" + std::string(text) + "'", std::move(why), std::move(fix)};
  };
  const auto dash = text.find('-', 1);
  const auto start = dash == std::string_view::npos ? std::nullopt : parse_double(text.substr(0, dash));
  const auto end = dash == std::string_view::npos ? std::nullopt : parse_double(text.substr(dash + 1));
  if (!start || !end || !std::isfinite(*start) || !std::isfinite(*end) || *start < 0)
    return fail("is not a stretch of time", "Write seconds: 1.20-2.05");
  if (*end < *start) return fail("ends before it starts", "Write the earlier time first");
  const double length = motion.seconds();
  if (*end > length + kSameInstant)
    return fail("reaches beyond the end of the motion at " + fixed(length, 3) + " s");
  const FrameRange range{
      static_cast<std::int64_t>(std::ceil((*start - kSameInstant) * motion.fps)),
      std::min(motion.num_frames(),
               static_cast<std::int64_t>(std::floor((*end + kSameInstant) * motion.fps)) + 1)};
  if (range.first >= range.end)
    return fail("holds no frame: they are " + fixed(1000 / motion.fps, 1) + " ms apart", "Make it longer");
  return range;
}

std::vector<std::int64_t> matching_channels(const Motion& motion, std::string_view pattern) {
  std::vector<std::int64_t> found;
  if (motion.space == MotionSpace::vertices) return found;
  for (std::size_t c = 0; c < motion.channels.size(); ++c)
    if (matches(pattern, motion.channels[c])) found.push_back(static_cast<std::int64_t>(c));
  if (!found.empty() || pattern.find_first_of("*?") != std::string_view::npos) return found;
  if (const auto name = match_arkit_name(pattern))
    if (const auto c = motion.find(*name)) found.push_back(*c);
  return found;
}

KeptValues::KeptValues(const Motion& motion)
    : num_frames_(motion.num_frames()),
      num_channels_(motion.num_channels()),
      values_(motion.values),
      weights_(motion.values.size()) {}

KeptValues::KeptValues(std::int64_t num_channels, std::vector<float> values, std::vector<float> weights)
    : num_channels_(num_channels), values_(std::move(values)), weights_(std::move(weights)) {
  contract(num_channels_ > 0 && values_.size() == weights_.size() &&
               values_.size() % static_cast<std::size_t>(num_channels_) == 0,
           "KeptValues: values and weights must be [N, C]");
  contract(std::all_of(weights_.begin(), weights_.end(), [](float w) { return w >= 0 && w <= 1; }),
           "KeptValues: a weight lies outside of 0 ... 1");
  num_frames_ = static_cast<std::int64_t>(values_.size()) / num_channels_;
}

bool KeptValues::keeps_frame(std::int64_t n) const {
  const auto row = weights_.begin() + static_cast<std::ptrdiff_t>(index(n, 0));
  return std::all_of(row, row + num_channels_, [](float w) { return w == 1; });
}

bool KeptValues::frees_frame(std::int64_t n) const {
  const auto row = weights_.begin() + static_cast<std::ptrdiff_t>(index(n, 0));
  return std::all_of(row, row + num_channels_, [](float w) { return w == 0; });
}

FrameRange KeptValues::edited() const {
  FrameRange range{0, num_frames_};
  while (range.first < range.end && keeps_frame(range.first)) ++range.first;
  while (range.first < range.end && keeps_frame(range.end - 1)) --range.end;
  return range.first < range.end ? range : FrameRange{};
}

void KeptValues::keep(std::int64_t n, std::int64_t c, float weight) {
  contract(n >= 0 && n < num_frames_ && c >= 0 && c < num_channels_, "KeptValues: no such frame or channel");
  contract(weight >= 0 && weight <= 1, "KeptValues: a weight lies outside of 0 ... 1");
  weights_[index(n, c)] = std::max(weights_[index(n, c)], weight);
}

void KeptValues::keep_outside(std::span<const FrameRange> stretches) {
  for (std::int64_t n = 0; n < num_frames_; ++n) {
    const bool is_inside = std::any_of(stretches.begin(), stretches.end(), [&](const FrameRange& range) {
      return n >= range.first && n < range.end;
    });
    if (!is_inside)
      std::fill_n(weights_.begin() + static_cast<std::ptrdiff_t>(index(n, 0)), num_channels_, 1.0f);
  }
}

void KeptValues::keep_channel(std::int64_t c) {
  for (std::int64_t n = 0; n < num_frames_; ++n) keep(n, c);
}

void KeptValues::set(std::int64_t n, std::int64_t c, float value) {
  keep(n, c);
  values_[index(n, c)] = value;
}

void KeptValues::paste(std::int64_t n, NoiseLevel level, std::span<const float> noise,
                       std::span<float> x) const {
  const auto width = static_cast<std::size_t>(num_channels_);
  contract(n >= 0 && n < num_frames_ && x.size() == width && (level.sigma == 0 || noise.size() == width),
           "KeptValues::paste: sizes disagree");
  const float *values = values_.data() + index(n, 0), *weights = weights_.data() + index(n, 0);
  for (std::size_t c = 0; c < width; ++c) {
    if (weights[c] == 0) continue;
    const float known = level.sigma == 0 ? values[c]
                                         : static_cast<float>(level.alpha * static_cast<double>(values[c]) +
                                                              level.sigma * static_cast<double>(noise[c]));
    x[c] = weights[c] == 1 ? known : weights[c] * known + (1 - weights[c]) * x[c];
  }
}

}  // namespace mien
