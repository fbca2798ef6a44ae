#include "mien/corpus/articulation.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "time_shape.h"

namespace mien {
namespace {

constexpr int kGridPerFrame = 4;
constexpr double kGridHz = kGridPerFrame * kCorpusFps;
constexpr double kFlankReach = 3.5;      // exp(-3.5^2) = 5e-6 is far below kRestDominance
constexpr float kRestDominance = 0.04f;  // weight of the rest position
constexpr double kFirstOfTwo = 0.55;     // share of a diphthong's first viseme
constexpr double kSmoothingS = 0.012;

struct Strengths {
  double jaw, lip;
};

// Short gaps do not close the mouth.
Strengths strengths_of(Viseme viseme, double seconds) {
  const VisemeTarget& row = viseme_target(viseme);
  if (viseme != Viseme::sil) return {row.jaw_strength, row.lip_strength};
  const double length = std::min(1.0, seconds / 0.25);
  return {row.jaw_strength * (0.25 + 0.75 * length), row.lip_strength * (0.2 + 0.8 * length)};
}

bool is_jaw_channel(std::size_t channel) {
  return channel == static_cast<std::size_t>(Articulator::jaw_open) ||
         channel == static_cast<std::size_t>(Articulator::jaw_thrust);
}

// The grid of weighted sums over phones, and the overrides.
class Blend {
 public:
  Blend(std::int64_t num_frames, const ArticulationStyle& style)
      : style_(style), num_(num_frames * kGridPerFrame), samples_(static_cast<std::size_t>(num_)) {}

  void add(Viseme viseme, double start_s, double end_s, double prominence, double gain) {
    const VisemeTarget& row = viseme_target(viseme);
    const double d = end_s - start_s;
    const double core_end = end_s - row.trim_end * d;
    const double core_start = std::min(core_end, start_s + row.trim_start * d - style_.lead_s);
    const double onset = row.onset_s * style_.width, release = row.release_s * style_.width;
    const Strengths strength = strengths_of(viseme, d);
    const std::array<double, kNumArticulators> gains = {
        style_.jaw * prominence, style_.round, style_.round, style_.spread, style_.lip, style_.lip, 1, 1};
    std::array<float, kNumArticulators> weighted{};
    for (std::size_t c = 0; c < weighted.size(); ++c)
      weighted[c] = static_cast<float>((is_jaw_channel(c) ? strength.jaw : strength.lip) * row.target[c] *
                                       gains[c] * gain);
    const auto jaw_strength = static_cast<float>(strength.jaw),
               lip_strength = static_cast<float>(strength.lip);

    const double first = std::max(0.0, std::ceil((core_start - kFlankReach * onset) * kGridHz));
    const double last =
        std::min(static_cast<double>(num_) - 1, std::floor((core_end + kFlankReach * release) * kGridHz));
    for (double i = first; i <= last; ++i) {
      const double t = i / kGridHz;
      const double flank = t < core_start ? (core_start - t) / onset
                           : t > core_end ? (t - core_end) / release
                                          : 0;
      const auto g = flank == 0 ? 1.0f : std::exp(static_cast<float>(-flank * flank));
      Sample& s = samples_[static_cast<std::size_t>(i)];
      for (std::size_t c = 0; c < weighted.size(); ++c) s.value[c] += g * weighted[c];
      s.jaw_weight += g * jaw_strength;
      s.lip_weight += g * lip_strength;
    }
  }

  void close_lips(const TimeSpan& window, bool builds_pressure) {
    const double middle = (window.start_s + window.end_s) / 2;
    const double half = std::max(0.022, (window.end_s - window.start_s) / 2);
    const double w = style_.width;
    raise<kClosure>({middle - half, middle + half, 0.075 * w, 0.060 * w});
    if (builds_pressure) raise<kPressure>({middle - 0.3 * half, middle + half, 0.050, 0.030});
  }

  void touch_teeth(double start_s, double end_s) {
    const double middle = (start_s + end_s) / 2;
    const double half = std::max(0.020, 0.4 * (end_s - start_s));
    raise<kLabiodental>({middle - half, middle + half, 0.080 * style_.width, 0.060 * style_.width});
  }

  // Divides by the weights, smooths in time, and keeps one of kGridPerFrame samples.
  std::vector<ArticulatorFrame> frames() {
    for (Sample& s : samples_)
      for (std::size_t c = 0; c < kNumArticulators; ++c)
        s.value[c] /= kRestDominance + (is_jaw_channel(c) ? s.jaw_weight : s.lip_weight);
    const auto window = smoothing_window();
    const auto reach = static_cast<std::int64_t>(window.size() / 2);
    std::vector<ArticulatorFrame> out(samples_.size() / kGridPerFrame);
    for (std::size_t n = 0; n < out.size(); ++n) {
      std::array<float, kNumValues> sum{};
      for (std::int64_t k = -reach; k <= reach; ++k) {
        const auto i =
            std::clamp<std::int64_t>(static_cast<std::int64_t>(n) * kGridPerFrame + k, 0, num_ - 1);
        const Sample& s = samples_[static_cast<std::size_t>(i)];
        const float w = window[static_cast<std::size_t>(k + reach)];
        for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += w * s.value[c];
      }
      std::copy_n(sum.begin(), kNumArticulators, out[n].blended.begin());
      out[n].closure = sum[kClosure];
      out[n].labiodental = sum[kLabiodental];
      out[n].pressure = sum[kPressure];
    }
    return out;
  }

 private:
  static constexpr std::size_t kClosure = kNumArticulators, kLabiodental = kClosure + 1,
                               kPressure = kClosure + 2;
  static constexpr std::size_t kNumValues = kNumArticulators + 3;
  struct Sample {
    std::array<float, kNumValues> value{};
    float jaw_weight = 0, lip_weight = 0;
  };

  template <std::size_t channel>
  void raise(const Bump& bump) {
    for_each_sample(bump, kGridHz, num_, [&](std::size_t i, double value) {
      float& now = samples_[i].value[channel];
      now = std::max(now, static_cast<float>(value));
    });
  }

  static std::vector<float> smoothing_window() {
    constexpr double kSigma = kSmoothingS * kGridHz;
    const int reach = static_cast<int>(std::ceil(4 * kSigma));
    std::vector<float> window;
    double sum = 0;
    for (int k = -reach; k <= reach; ++k) sum += std::exp(-0.5 * k * k / (kSigma * kSigma));
    for (int k = -reach; k <= reach; ++k)
      window.push_back(static_cast<float>(std::exp(-0.5 * k * k / (kSigma * kSigma)) / sum));
    return window;
  }

  ArticulationStyle style_;
  std::int64_t num_;
  std::vector<Sample> samples_;
};

}  // namespace

ArticulationStyle articulation_style(const Speaker& speaker, Emotion emotion, double intensity) {
  const EmotionGains& gains = emotion_gains(emotion);
  return {.jaw = speaker.jaw * scaled_gain(gains.jaw, intensity),
          .lip = speaker.lip * scaled_gain(gains.lip, intensity),
          .round = speaker.round * scaled_gain(gains.round, intensity),
          .spread = speaker.spread * scaled_gain(gains.spread, intensity),
          .press = speaker.press,
          .width = speaker.width,
          .lead_s = speaker.lead_s,
          .asymmetry = speaker.asymmetry};
}

std::vector<ArticulatorFrame> articulate(std::span<const PhoneSegment> phones, const ArticulationStyle& style,
                                         std::int64_t num_frames, std::span<const double> phone_gains) {
  contract(phone_gains.empty() || phone_gains.size() == phones.size(), "articulate: one gain per phone");
  if (num_frames <= 0) return {};
  Blend blend(num_frames, style);
  for (std::size_t p = 0; p < phones.size(); ++p) {
    const PhoneSegment& phone = phones[p];
    const double gain = phone_gains.empty() ? 1 : phone_gains[p];
    const double split = phone.visemes.second ? phone.start_s + kFirstOfTwo * phone.seconds() : phone.end_s;
    blend.add(phone.visemes.first, phone.start_s, split, phone.prominence, gain);
    if (phone.visemes.second) blend.add(*phone.visemes.second, split, phone.end_s, phone.prominence, gain);
    if (phone.is_bilabial())
      blend.close_lips(phone.closure ? *phone.closure : default_closure(phone),
                       is_bilabial_stop(phone.label));
    if (phone.visemes.first == Viseme::FF) blend.touch_teeth(phone.start_s, phone.end_s);
  }
  return blend.frames();
}

}  // namespace mien
