#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mien/core/audio_clip.h"
#include "mien/corpus/prominence.h"

namespace mien {
namespace {

// Pitch is searched at a quarter of the rate: the autocorrelation costs 16 times less and speech above 2 kHz
// says little about it.
constexpr std::size_t kDecimation = 4;
constexpr double kRateHz = double(kModelSampleRateHz) / kDecimation;
constexpr std::size_t kWindow = 320;  // 80 ms
constexpr std::size_t kHop = 40;      // 10 ms
constexpr double kMinHz = 65, kMaxHz = 400;
constexpr std::size_t kMinLag = 10, kMaxLag = 62;  // of 400 Hz and 65 Hz
constexpr float kVoicedPeak = 0.45f;

// Low-pass (windowed sinc, 1.6 kHz) and every fourth sample; the same delay of zero everywhere.
std::vector<float> decimated(std::span<const float> x) {
  constexpr int kReach = 24;
  static const auto filter = [] {
    std::array<float, 2 * kReach + 1> h{};
    double sum = 0;
    std::array<double, 2 * kReach + 1> exact{};
    for (int k = -kReach; k <= kReach; ++k) {
      const double u = 0.2 * k;  // 2 * 1600 Hz / 16 kHz
      const double sinc = k == 0 ? 1 : std::sin(std::numbers::pi * u) / (std::numbers::pi * u);
      const double hann = 0.5 + 0.5 * std::cos(std::numbers::pi * k / (kReach + 1));
      sum += exact[static_cast<std::size_t>(k + kReach)] = sinc * hann;
    }
    for (std::size_t k = 0; k < h.size(); ++k) h[k] = static_cast<float>(exact[k] / sum);
    return h;
  }();
  const auto size = static_cast<std::int64_t>(x.size());
  std::vector<float> out((x.size() + kDecimation - 1) / kDecimation);
  for (std::size_t n = 0; n < out.size(); ++n) {
    const auto centre = static_cast<std::int64_t>(n * kDecimation);
    const std::int64_t first = std::max<std::int64_t>(0, centre - kReach),
                       last = std::min(size - 1, centre + kReach);
    float sum = 0;
    for (std::int64_t i = first; i <= last; ++i)
      sum += filter[static_cast<std::size_t>(i - centre + kReach)] * x[static_cast<std::size_t>(i)];
    out[n] = sum;
  }
  return out;
}

// Pitch of one window, 0 when unvoiced.
float pitch_of(const std::array<float, kWindow>& window) {
  std::array<float, kWindow + kMaxLag + 2> padded{};
  std::copy(window.begin(), window.end(), padded.begin());
  std::array<float, kMaxLag + 2> r{};
  for (std::size_t i = 0; i < kWindow;
       ++i)  // lags inside: sums side by side, which the compiler can vectorise
    for (std::size_t lag = kMinLag - 1; lag < r.size(); ++lag) r[lag] += padded[i] * padded[i + lag];
  float energy = 0;
  for (const float v : window) energy += v * v;
  if (energy <= 0) return 0;
  std::size_t best = kMinLag;
  for (std::size_t lag = kMinLag; lag <= kMaxLag; ++lag)
    if (r[lag] > r[best]) best = lag;
  // At a border of the range the largest value is no peak.
  if (r[best] < kVoicedPeak * energy || r[best - 1] > r[best] || r[best + 1] > r[best]) return 0;
  const double left = r[best - 1], middle = r[best], right = r[best + 1];
  const double bend = left - 2 * middle + right;
  const double offset = bend < 0 ? 0.5 * (left - right) / bend : 0;  // of a parabola through the three
  return static_cast<float>(std::clamp(kRateHz / (static_cast<double>(best) + offset), kMinHz, kMaxHz));
}

}  // namespace

std::vector<float> track_pitch(std::span<const float> samples_16k) {
  const std::vector<float> x = decimated(samples_16k);
  std::vector<float> track(samples_16k.size() / (kHop * kDecimation) + 1);
  std::array<float, kWindow> window{};
  for (std::size_t t = 0; t < track.size(); ++t) {
    double mean = 0;
    for (std::size_t i = 0; i < kWindow; ++i) {
      const std::size_t position = t * kHop + i;  // of the window's sample, kWindow / 2 further on
      const bool is_inside = position >= kWindow / 2 && position - kWindow / 2 < x.size();
      window[i] = is_inside ? x[position - kWindow / 2] : 0.0f;
      mean += window[i];
    }
    mean /= kWindow;
    for (float& v : window) v -= static_cast<float>(mean);
    track[t] = pitch_of(window);
  }
  return track;
}

}  // namespace mien
