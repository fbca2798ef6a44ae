#include "kept_face.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/core/arkit.h"

namespace mien::default_model {
namespace {

constexpr double kFps = 60;
constexpr std::int64_t kNumChannels = 55;

// Events are what rises above a curve and is over within a time: longer than a blink, or a raise, can last.
constexpr std::int64_t kBlinkReach = 18, kRaiseReach = 24;  // frames to either side
constexpr float kEventStarts = 0.05f, kBlinkHappens = 0.3f, kRaiseHappens = 0.08f;

// The curve without what rises from it for fewer than 2 reach + 1 frames: the largest of the smallest values
// around (opening, in the terms of image processing). Frames that are not kept do not count.
std::vector<float> without_peaks(const std::vector<float>& curve, const std::vector<bool>& counts,
                                 std::int64_t reach) {
  const auto num_frames = static_cast<std::int64_t>(curve.size());
  const auto extreme = [&](const std::vector<float>& from, bool smallest) {
    std::vector<float> out = from;
    for (std::int64_t n = 0; n < num_frames; ++n) {
      if (!counts[static_cast<std::size_t>(n)]) continue;
      for (std::int64_t k = std::max<std::int64_t>(n - reach, 0); k <= std::min(n + reach, num_frames - 1);
           ++k) {
        if (!counts[static_cast<std::size_t>(k)]) continue;
        float& best = out[static_cast<std::size_t>(n)];
        best = smallest ? std::min(best, from[static_cast<std::size_t>(k)])
                        : std::max(best, from[static_cast<std::size_t>(k)]);
      }
    }
    return out;
  };
  return extreme(extreme(curve, true), false);
}

// Frames in which the height begins to rise towards at least `happens`.
std::vector<bool> onsets(const std::vector<float>& height, float happens) {
  std::vector<bool> begins(height.size());
  bool is_up = false;
  for (std::size_t n = 0; n < height.size(); ++n) {
    if (height[n] < kEventStarts) is_up = false;
    if (is_up || height[n] < happens) continue;
    is_up = true;
    std::size_t first = n;
    while (first > 0 && height[first - 1] >= kEventStarts) --first;
    begins[first] = true;
  }
  return begins;
}

}  // namespace

KeptFace::KeptFace(const KeptValues& kept, const Statistics<Tensor>& statistics)
    : num_frames_(kept.num_frames()) {
  contract(kept.num_channels() == kNumChannels, "KeptFace: the 55 channels of the default model expected");
  const auto count = static_cast<std::size_t>(num_frames_);
  const auto curve = [&](std::size_t c) {
    std::vector<float> values(count);
    for (std::int64_t n = 0; n < num_frames_; ++n)
      values[static_cast<std::size_t>(n)] = kept.value(n, static_cast<std::int64_t>(c));
    return values;
  };
  const auto keeps = [&](std::size_t c) {
    std::vector<bool> flags(count);
    for (std::int64_t n = 0; n < num_frames_; ++n)
      flags[static_cast<std::size_t>(n)] = kept.keeps(n, static_cast<std::int64_t>(c));
    return flags;
  };

  std::vector<std::vector<float>> curves;  // [55][N] without events
  std::vector<std::vector<bool>> known;
  for (std::size_t c = 0; c < kNumChannels; ++c) {
    curves.push_back(curve(c));
    known.push_back(keeps(c));
  }
  // How far an event lifts a curve of the motion, 0 ... 1.
  const auto heights = [&](std::string_view name, std::int64_t reach) {
    const std::size_t c = arkit_index(name);
    const std::vector<float> base = without_peaks(curves[c], known[c], reach);
    std::vector<float> height(count);
    for (std::size_t n = 0; n < count; ++n)
      if (known[c][n] && base[n] < 1) height[n] = (curves[c][n] - base[n]) / (1 - base[n]);
    curves[c] = base;
    return height;
  };
  const std::vector<float> left = heights("eyeBlinkLeft", kBlinkReach),
                           right = heights("eyeBlinkRight", kBlinkReach);
  const std::vector<float> raise = heights("browInnerUp", kRaiseReach);
  for (const char* name : {"eyeSquintLeft", "eyeSquintRight"}) heights(name, kBlinkReach);
  for (const char* name : {"browOuterUpLeft", "browOuterUpRight"}) heights(name, kRaiseReach);
  for (const char* name : {"eyeWideLeft", "eyeWideRight"}) {  // a blink hides it
    std::vector<float>& wide = curves[arkit_index(name)];
    for (float& v : wide) v = -v;
    wide = without_peaks(wide, known[arkit_index(name)], kBlinkReach);
    for (float& v : wide) v = -v;
  }

  const auto &keeps_left = known[arkit_index("eyeBlinkLeft")],
             &keeps_right = known[arkit_index("eyeBlinkRight")];
  std::vector<float> lids(count);
  for (std::size_t n = 0; n < count; ++n) {
    lids[n] = std::max(left[n], right[n]);
    closures_.push_back({left[n], right[n]});
    keeps_lid_.push_back({keeps_left[n], keeps_right[n]});
    blinks_.is_kept.push_back(keeps_left[n] || keeps_right[n]);
  }
  blinks_.begins = onsets(lids, kBlinkHappens);
  raises_ = {known[arkit_index("browInnerUp")], onsets(raise, kRaiseHappens)};

  // A number is known when all channels that it is made of are.
  std::array<std::array<bool, kNumUpper>, kNumChannels> is_made_of{};
  for (std::size_t c = 0; c < kNumChannels; ++c) {
    std::array<float, kNumChannels> one{};
    std::array<float, kNumFace> face{};
    one[c] = 1;
    encode_face(one, face);
    for (std::size_t u = 0; u < kNumUpper; ++u) is_made_of[c][u] = face[kNumLower + u] != 0;
  }
  const auto mean = statistics.face_mean.values(), sd = statistics.face_sd.values();
  for (std::size_t n = 0; n < count; ++n) {
    std::array<float, kNumChannels> channels{};
    std::array<float, kNumFace> face{};
    std::array<bool, kNumUpper> is_known{};
    is_known.fill(true);
    for (std::size_t c = 0; c < kNumChannels; ++c) {
      channels[c] = curves[c][n];
      for (std::size_t u = 0; u < kNumUpper; ++u)
        if (is_made_of[c][u] && !known[c][n]) is_known[u] = false;
    }
    encode_face(channels, face);
    std::array<float, kNumUpper> upper{};
    for (std::size_t u = 0; u < kNumUpper; ++u)
      upper[u] = std::clamp((face[kNumLower + u] - mean[kNumLower + u]) / sd[kNumLower + u],
                            -kLargestStandardised, kLargestStandardised);
    upper_.push_back(upper);
    is_known_.push_back(is_known);
  }
}

KeptFace::Chunk KeptFace::chunk(std::int64_t index) const {
  constexpr std::int64_t kStep = kChunkFrames / kChunkSamples;
  constexpr std::int64_t kNumbers = kChunkSamples * kNumUpper;
  Chunk out{std::vector<float>(kNumbers), std::vector<bool>(kNumbers), true, true};
  for (std::size_t u = 0; u < kNumUpper; ++u) {
    bool is_known = true;
    for (std::int64_t f = 0; f < kChunkFrames; ++f) {
      const std::int64_t n = index * kChunkFrames + f;
      is_known &= n < num_frames_ && is_known_[static_cast<std::size_t>(n)][u];
    }
    (is_known ? out.is_free : out.is_known_entirely) = false;
    if (!is_known) continue;
    for (std::int64_t i = 0; i < kChunkSamples; ++i) {
      const auto at = static_cast<std::size_t>(i * kNumUpper) + u;
      out.is_known[at] = true;
      out.samples[at] = upper_[static_cast<std::size_t>(index * kChunkFrames + i * kStep)][u];
    }
  }
  return out;
}

std::optional<int> KeptFace::event_class(const Events& events, std::int64_t first, std::int64_t count) {
  int found = 0;
  for (std::int64_t f = 0; f < count; ++f) {
    const std::int64_t n = first + f;
    if (n < 0) continue;
    if (n >= static_cast<std::int64_t>(events.is_kept.size()) || !events.is_kept[static_cast<std::size_t>(n)])
      return std::nullopt;
    if (found == 0 && events.begins[static_cast<std::size_t>(n)]) found = static_cast<int>(f) + 1;
  }
  return found;
}

bool KeptFace::is_free(const Events& events, double from_s, double to_s) {
  const auto first = static_cast<std::int64_t>(std::floor(from_s * kFps));
  const auto last = static_cast<std::int64_t>(std::ceil(to_s * kFps));
  for (std::int64_t n = std::max<std::int64_t>(first, 0);
       n <= std::min(last, static_cast<std::int64_t>(events.is_kept.size()) - 1); ++n)
    if (events.is_kept[static_cast<std::size_t>(n)]) return false;
  return true;
}

LidClosure KeptFace::closure(std::int64_t n, LidClosure drawn) const {
  if (n >= num_frames_) return drawn;
  const auto [left, right] = keeps_lid_[static_cast<std::size_t>(n)];
  if (left == right) return drawn;
  const float of_kept =
      left ? closures_[static_cast<std::size_t>(n)].left : closures_[static_cast<std::size_t>(n)].right;
  return {of_kept, of_kept};
}

}  // namespace mien::default_model
