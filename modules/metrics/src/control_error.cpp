#include "mien/metrics/control_error.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "mean_of_defined.h"
#include "mien/core/arkit.h"
#include "mien/core/rig_controls.h"
#include "undefined.h"

namespace mien {
namespace {

double mean_distance(const Motion& a, const Motion& b, std::int64_t num_frames,
                     std::span<const std::size_t> channels) {
  double sum = 0;
  for (std::int64_t n = 0; n < num_frames; ++n) {
    double squares = 0;
    for (const std::size_t c : channels) {
      const double d = static_cast<double>(a.frame(n)[c]) - static_cast<double>(b.frame(n)[c]);
      squares += d * d;
    }
    sum += std::sqrt(squares);
  }
  return sum / static_cast<double>(num_frames);
}

// Standard deviation over frames of the sum of squares of some channels.
double energy_deviation(const Motion& motion, std::int64_t num_frames,
                        std::span<const std::size_t> channels) {
  std::vector<double> energies(static_cast<std::size_t>(num_frames));
  double mean = 0, squares = 0;
  for (std::size_t n = 0; n < energies.size(); ++n) {
    const auto frame = motion.frame(static_cast<std::int64_t>(n));
    for (const std::size_t c : channels)
      energies[n] += static_cast<double>(frame[c]) * static_cast<double>(frame[c]);
    mean += energies[n] / static_cast<double>(num_frames);
  }
  for (const double e : energies) squares += (e - mean) * (e - mean);
  return std::sqrt(squares / static_cast<double>(num_frames));
}

}  // namespace

std::optional<ControlRegions> control_regions(std::int64_t num_channels) {
  if (num_channels == static_cast<std::int64_t>(kNumArkit) - 1) {
    const auto mouth = beat_mouth(), upper = beat_upper_face();
    return ControlRegions{{mouth.begin(), mouth.end()}, {upper.begin(), upper.end()}};
  }
  if (num_channels != static_cast<std::int64_t>(kNumUudamm)) return std::nullopt;
  ControlRegions regions{uudamm_mouth(), {}};
  for (std::size_t c = 0; c < kNumUudamm; ++c)
    if (!std::binary_search(regions.mouth.begin(), regions.mouth.end(), c)) regions.upper.push_back(c);
  return regions;
}

Status ControlErrors::add(std::string name, const Motion& truth, const Motion& predicted) {
  const auto fail = [&](std::string why) {
    return Error{Errc::incompatible, "'" + name + "'", std::move(why), ""};
  };
  const auto width = static_cast<std::size_t>(truth.num_channels());
  if (predicted.num_channels() != truth.num_channels())
    return fail("has " + std::to_string(predicted.num_channels()) + " channels in the prediction and " +
                std::to_string(width) + " in the truth");
  for (const auto* region : {&regions_.mouth, &regions_.upper})
    for (const std::size_t c : *region)
      if (c >= width)
        return fail("a region names channel " + std::to_string(c) + " of " + std::to_string(width));
  std::vector<std::size_t> all(width);
  for (std::size_t c = 0; c < width; ++c) all[c] = c;
  ControlError own{std::move(name), std::min(truth.num_frames(), predicted.num_frames()), kNan, kNan, kNan};
  if (own.num_frames > 0) {
    own.mce = mean_distance(truth, predicted, own.num_frames, all);
    if (!regions_.mouth.empty()) own.lce = mean_distance(truth, predicted, own.num_frames, regions_.mouth);
    if (!regions_.upper.empty())
      own.fdd = energy_deviation(truth, own.num_frames, regions_.upper) -
                energy_deviation(predicted, own.num_frames, regions_.upper);
  }
  sequences_.push_back(std::move(own));
  return Done{};
}

std::int64_t ControlErrors::num_frames() const {
  std::int64_t sum = 0;
  for (const auto& sequence : sequences_) sum += sequence.num_frames;
  return sum;
}

double ControlErrors::mce() const {
  return mean_of_defined(sequences_, [](const ControlError& e) { return e.mce; });
}
double ControlErrors::lce() const {
  return mean_of_defined(sequences_, [](const ControlError& e) { return e.lce; });
}
double ControlErrors::fdd() const {
  return mean_of_defined(sequences_, [](const ControlError& e) { return e.fdd; });
}
double ControlErrors::absolute_fdd() const {
  return mean_of_defined(sequences_, [](const ControlError& e) { return std::abs(e.fdd); });
}

}  // namespace mien
