#include "augment.h"

#include <algorithm>
#include <cmath>

#include "filters.h"
#include "mien/base/hash.h"
#include "mien/core/audio_clip.h"

namespace mien {
namespace {

double rms(std::span<const float> x) {
  double sum = 0;
  for (const float v : x) sum += static_cast<double>(v) * v;
  return x.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(x.size()));
}

AddedNoise draw_noise(Rng& rng, double low_db, double high_db) {
  AddedNoise noise;
  const double pick = rng.uniform();
  noise.kind = pick < 0.35 ? NoiseKind::white : pick < 0.70 ? NoiseKind::brown : NoiseKind::babble;
  noise.pole = rng.uniform(0.7, 0.985);
  noise.voices = 2 + static_cast<int>(rng.below(4));
  noise.snr_db = rng.uniform(low_db, high_db);
  return noise;
}

// Impulse response: the direct sound, then white noise that falls by 60 dB in rt60 seconds, its first 2 ms
// empty.
std::vector<float> room_response(const Reverb& reverb, Rng& rng) {
  const auto count = static_cast<std::size_t>(reverb.rt60_s * kModelSampleRateHz);
  const std::size_t gap = kModelSampleRateHz * 2 / 1000;
  std::vector<float> response(std::max(count, gap + 1), 0.0f);
  double energy = 0;
  for (std::size_t i = gap; i < response.size(); ++i) {
    const double t = static_cast<double>(i) / kModelSampleRateHz;
    response[i] = static_cast<float>(rng.normal() * std::exp(-6.9 * t / reverb.rt60_s));
    energy += static_cast<double>(response[i]) * response[i];
  }
  const auto scale = static_cast<float>(energy > 0 ? std::sqrt(reverb.tail_ratio / energy) : 0.0);
  for (auto& v : response) v *= scale;
  response[0] = 1.0f;
  return response;
}

void color(std::vector<float>& x, const Coloration& c) {
  const auto low = low_pass(x, c.hz);
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] += static_cast<float>(c.gain) * (c.is_high ? x[i] - low[i] : low[i]);
}

// Eight-bit mu-law (ITU-T G.711's continuous form, mu = 255): compress, round to 256 levels, expand.
float mu_law(float v) {
  constexpr double kMu = 255;
  const double x = std::clamp(static_cast<double>(v), -1.0, 1.0);
  const double compressed = std::copysign(std::log1p(kMu * std::abs(x)) / std::log1p(kMu), x);
  const double rounded = std::round(compressed * 127.5) / 127.5;
  return static_cast<float>(std::copysign(std::expm1(std::abs(rounded) * std::log1p(kMu)) / kMu, rounded));
}

}  // namespace

AugmentRecipe draw_training_recipe(Rng& rng) {
  AugmentRecipe r;
  r.seed = (static_cast<std::uint64_t>(rng.bits()) << 32) | rng.bits();
  r.gain_db = rng.uniform(-14, 8);
  if (!rng.chance(0.85)) {
    r.noise = draw_noise(rng, 30, 50);
    return r;
  }
  if (rng.chance(0.7)) r.time_factor = rng.uniform(0.86, 1.16);
  if (rng.chance(0.4)) r.reverb = Reverb{rng.uniform(0.12, 0.6), rng.uniform(0.05, 0.4)};
  if (rng.chance(0.7))
    r.coloration = Coloration{rng.chance(0.5), rng.uniform(300, 3000), rng.uniform(-0.6, 2.0)};
  if (rng.chance(0.3)) r.band = Band{rng.uniform(80, 320), rng.uniform(3200, 6500)};
  r.noise = draw_noise(rng, 5, 35);
  if (rng.chance(0.15)) r.clip_level = rng.uniform(0.08, 0.25);
  r.mu_law = rng.chance(0.2);
  return r;
}

std::vector<float> make_noise(const AddedNoise& noise, std::size_t count, const BabblePool& pool, Rng& rng) {
  std::vector<float> out(count, 0.0f);
  const bool has_babble =
      noise.kind == NoiseKind::babble &&
      std::any_of(pool.begin(), pool.end(), [](const auto& clip) { return !clip.empty(); });
  if (has_babble) {
    for (int v = 0; v < noise.voices; ++v) {
      const auto& clip = pool[rng.below(pool.size())];
      if (clip.empty()) continue;
      std::size_t at = rng.below(clip.size());
      for (auto& x : out) {
        x += clip[at];
        at = at + 1 == clip.size() ? 0 : at + 1;
      }
    }
  } else {
    const double pole = noise.kind == NoiseKind::white ? 0.0 : noise.pole;
    double state = 0;
    for (auto& x : out) {
      state = pole * state + rng.normal();
      x = static_cast<float>(state);
    }
  }
  const double level = rms(out);
  if (level > 0)
    for (auto& x : out) x = static_cast<float>(x / level);
  return out;
}

std::vector<float> augment(std::span<const float> samples, const AugmentRecipe& r, const BabblePool& pool) {
  auto x = resample_audio(samples, kModelSampleRateHz, kModelSampleRateHz * r.time_factor);
  normalise_loudness(x);
  Rng rng(hash_combine(hash64("augment"), r.seed));
  if (r.reverb) x = convolve(x, room_response(*r.reverb, rng));
  if (r.coloration) color(x, *r.coloration);
  if (r.band) band_limit(x, r.band->low_hz, r.band->high_hz);
  if (r.noise) {
    constexpr double kLevelOfSilence =
        0.06;  // the noise of a recording without speech, as if speech had been there
    const double speech = active_rms(x);
    const double level = (speech > 0 ? speech : kLevelOfSilence) * std::pow(10.0, -r.noise->snr_db / 20);
    const auto noise = make_noise(*r.noise, x.size(), pool, rng);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += static_cast<float>(level) * noise[i];
  }
  if (r.clip_level)
    for (auto& v : x)
      v = std::clamp(v, static_cast<float>(-*r.clip_level), static_cast<float>(*r.clip_level));
  if (r.mu_law)
    for (auto& v : x) v = mu_law(v);
  const auto gain = static_cast<float>(std::pow(10.0, r.gain_db / 20));
  for (auto& v : x) v *= gain;
  return x;
}

}  // namespace mien
