#include "mel_augmentation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mien/audio/log_mel.h"
#include "mien/base/contract.h"

namespace mien::train {
namespace {

constexpr auto kBands = static_cast<std::size_t>(kNumMelBands);
constexpr double kNepersPerDb = std::numbers::ln10 / 10;  // of power
constexpr float kMasked = -8.0f;                          // a mask looks like quiet, which the network knows

std::size_t num_frames(std::span<const float> mel) {
  contract(mel.size() % kBands == 0, "mel augmentation: whole frames of 64 bands");
  return mel.size() / kBands;
}

void warp_bands(std::span<float> mel, double warp, const std::array<float, kBands>& offset) {
  std::array<float, kBands> frame;
  for (std::size_t t = 0; t < num_frames(mel); ++t) {
    float* row = mel.data() + t * kBands;
    std::copy(row, row + kBands, frame.begin());
    for (std::size_t b = 0; b < kBands; ++b) {
      const double position = std::min(static_cast<double>(b) * warp, static_cast<double>(kBands - 1));
      const auto left = static_cast<std::size_t>(position);
      const auto right = std::min(left + 1, kBands - 1);
      const auto w = static_cast<float>(position - static_cast<double>(left));
      row[b] = frame[left] + w * (frame[right] - frame[left]) + offset[b];
    }
  }
}

void mask(std::span<float> mel, Rng& rng) {
  const std::size_t frames = num_frames(mel);
  for (int i = 0; i < 2; ++i) {
    const auto width = rng.below(8), first = rng.below(kBands - width + 1);
    for (std::size_t t = 0; t < frames; ++t) std::fill_n(mel.data() + t * kBands + first, width, kMasked);
  }
  const auto width = std::min<std::uint64_t>(rng.below(11), frames);
  const auto first = rng.below(frames - width + 1);
  std::fill_n(mel.data() + first * kBands, width * kBands, kMasked);
}

}  // namespace

void augment_mel(std::span<float> mel, double level_offset_sd_db, Rng& rng) {
  if (mel.empty()) return;
  const double warp = rng.chance(0.6) ? rng.uniform(0.88, 1.14) : 1.0;
  const auto level = static_cast<float>(rng.normal(0, level_offset_sd_db) * kNepersPerDb);
  std::array<float, kBands> offset;
  for (float& o : offset) o = static_cast<float>(rng.normal(0, 0.15));
  warp_bands(mel, warp, offset);
  for (float& v : mel) v += level;
  mask(mel, rng);
}

}  // namespace mien::train
