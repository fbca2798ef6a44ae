#include "mien/metrics/bootstrap.h"

#include <cmath>
#include <map>

#include "mien/base/random.h"
#include "mien/metrics/statistics.h"

namespace mien {

std::vector<std::vector<std::size_t>> speaker_draws(const std::vector<std::string>& speakers, int num_draws,
                                                    std::uint64_t seed) {
  std::map<std::string, std::vector<std::size_t>> clips_of;
  for (std::size_t i = 0; i < speakers.size(); ++i) clips_of[speakers[i]].push_back(i);
  std::vector<const std::vector<std::size_t>*> groups;
  for (const auto& [name, clips] : clips_of) groups.push_back(&clips);
  Rng rng(seed);
  std::vector<std::vector<std::size_t>> draws(static_cast<std::size_t>(num_draws));
  for (auto& draw : draws) {
    for (std::size_t s = 0; s < groups.size(); ++s) {
      const auto& clips = *groups[rng.below(groups.size())];
      for (std::size_t i = 0; i < clips.size(); ++i) draw.push_back(clips[rng.below(clips.size())]);
    }
  }
  return draws;
}

Interval interval_of(std::vector<double> draws) {
  std::erase_if(draws, [](double v) { return std::isnan(v); });
  return {percentile(draws, 2.5), percentile(draws, 97.5)};
}

}  // namespace mien
