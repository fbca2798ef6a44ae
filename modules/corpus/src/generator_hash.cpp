#include <bit>

#include "mien/base/hash.h"
#include "mien/corpus/take.h"
#include "mien/corpus/viseme.h"

namespace mien {
namespace {

// Increase when code (not a table) changes what a seed gives.
constexpr std::uint64_t kGeneratorVersion = 1;

std::uint64_t with(std::uint64_t hash, double value) {
  return hash_combine(hash, std::bit_cast<std::uint64_t>(value));
}

std::uint64_t with(std::uint64_t h, const VisemeTarget& t) {
  for (const double target : t.target) h = with(h, target);
  for (const double v : {t.jaw_strength, t.lip_strength, t.onset_s, t.release_s, t.trim_start, t.trim_end})
    h = with(h, v);
  return h;
}

std::uint64_t with(std::uint64_t h, const Speaker& s) {
  for (const double v : {s.jaw,
                         s.lip,
                         s.round,
                         s.spread,
                         s.press,
                         s.width,
                         s.lead_s,
                         s.asymmetry,
                         s.rest_smile,
                         s.rest_brow,
                         s.blinks_per_minute,
                         s.brow_probability,
                         s.brow_amplitude,
                         s.nod_probability,
                         s.nod_deg,
                         s.gaze_away,
                         s.gaze_deg,
                         s.head_deg,
                         s.squint_talk,
                         s.emotion_gain})
    h = with(h, v);
  return hash_combine(h, s.mirror_contempt);
}

}  // namespace

std::uint64_t generator_hash() {
  std::uint64_t h = kGeneratorVersion;
  for (int v = 0; v < kNumVisemes; ++v) h = with(h, viseme_target(static_cast<Viseme>(v)));
  for (const Speaker& speaker : fixed_speakers()) h = with(h, speaker);
  for (int e = 0; e < kNumEmotions; ++e) {
    const auto emotion = static_cast<Emotion>(e);
    for (const float value : apex_pose(emotion)) h = with(h, value);
    const EmotionGains& g = emotion_gains(emotion);
    for (const double v : {g.jaw, g.lip, g.round, g.spread, g.blink_rate}) h = with(h, v);
  }
  return h;
}

}  // namespace mien
