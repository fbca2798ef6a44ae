#include "usual_acceleration.h"

#include <algorithm>
#include <cmath>

namespace mien {
namespace {

double percentile_95(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

constexpr std::size_t kNumParts = 4;

std::size_t part_of(const Motion& names, std::size_t c) {
  if (names.space == MotionSpace::vertices) return 0;
  const std::string& name = names.channels[c];
  if (name.starts_with("head")) return 3;
  if (name.starts_with("eyeLook")) return 2;
  return name.starts_with("eye") || name.starts_with("brow") ? 1 : 0;
}

}  // namespace

UsualAcceleration::UsualAcceleration(const KeptValues& motion, const Motion& names)
    : motion_(motion), parts_(kNumParts) {
  const std::int64_t num_frames = motion.num_frames();
  for (Part& part : parts_) part.squares.resize(static_cast<std::size_t>(num_frames));
  for (std::int64_t c = 0; c < motion.num_channels(); ++c) {
    part_of_.push_back(part_of(names, static_cast<std::size_t>(c)));
    Part& part = parts_[part_of_.back()];
    std::vector<double> all;
    for (std::int64_t n = 1; n + 1 < num_frames; ++n) {
      all.push_back(own(n, c));
      part.squares[static_cast<std::size_t>(n)] += all.back() * all.back();
    }
    channels_.push_back(percentile_95(std::move(all)));
    part.share_square += channels_.back() * channels_.back();
  }
  for (Part& part : parts_)
    if (num_frames > 2) part.usual_square = percentile_95({part.squares.begin() + 1, part.squares.end() - 1});
}

double UsualAcceleration::own(std::int64_t n, std::int64_t c) const {
  if (n < 1 || n + 1 >= motion_.num_frames()) return 0;
  return std::abs(static_cast<double>(motion_.value(n - 1, c)) -
                  2 * static_cast<double>(motion_.value(n, c)) +
                  static_cast<double>(motion_.value(n + 1, c)));
}

double UsualAcceleration::limit(std::int64_t n, std::int64_t c) const {
  constexpr double kShare = 0.9;  // of what is usual
  const Part& part = parts_[part_of_[static_cast<std::size_t>(c)]];
  const double of_motion = own(n, c), usual = of_channel(c);
  const double room = kShare * kShare * part.usual_square - part.squares[static_cast<std::size_t>(n)];
  if (!(room > 0) || !(part.share_square > 0)) return of_motion;
  return std::sqrt(of_motion * of_motion + room * usual * usual / part.share_square);
}

}  // namespace mien
