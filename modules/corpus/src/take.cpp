#include "mien/corpus/take.h"

#include <algorithm>
#include <cmath>

#include "arkit_channels.h"
#include "mien/base/contract.h"
#include "mien/base/hash.h"
#include "mien/corpus/articulation.h"
#include "mien/corpus/gestures.h"
#include "time_shape.h"

namespace mien {
namespace {

constexpr double kPhoneGainSpread = 0.16;
constexpr double kWarpKnotS = 0.35, kWarpSpreadS = 0.014;
constexpr double kMaxHorizontalDeg = 33, kMaxVerticalDeg = 28;  // gaze at coefficient 1

// Every process has a generator of its own.
enum class Stream : std::uint64_t { latent = 1, articulation, expression, gaze, brows, head, blinks };
Rng stream_of(std::uint64_t seed, Stream stream) {
  return Rng(hash_combine(seed, static_cast<std::uint64_t>(stream)));
}

// Emotional pose over time (section 5).
struct Expression {
  ArkitFrame pose{};            // already scaled by intensity, speaker and take
  std::vector<float> envelope;  // [N]
};

// Everything that makes one take, before it is put together frame by frame.
struct Parts {
  ArticulationStyle style;
  std::vector<ArticulatorFrame> mouth;  // [N]
  Expression expression;
  GazeTrack gaze;
  BrowTrack brows;
  HeadTrack head;
  std::vector<float> activity;  // [N]
};

double onset_of_expression(double t) { return smooth_step((t + 0.35) / 0.5); }

Expression express(const Speaker& speaker, Emotion emotion, double strength, const std::vector<float>& walk) {
  Expression e;
  e.pose = apex_pose(emotion);
  if (speaker.mirror_contempt && emotion == Emotion::contempt) e.pose = mirrored(e.pose);
  for (float& value : e.pose) value *= static_cast<float>(strength * speaker.emotion_gain);
  e.envelope.resize(walk.size());
  for (std::size_t n = 0; n < walk.size(); ++n) {
    const double wander = std::clamp(1.0 + walk[n], 0.6, 1.35);
    e.envelope[n] = static_cast<float>(wander * onset_of_expression(static_cast<double>(n) / kCorpusFps));
  }
  return e;
}

// Adds smooth random offsets to all phone and closure times: knots every 0.35 s, linear between.
void warp_times(std::vector<PhoneSegment>& phones, double seconds, Rng& rng) {
  std::vector<double> offsets(static_cast<std::size_t>(seconds / kWarpKnotS) + 2);
  for (double& offset : offsets) offset = rng.normal(0, kWarpSpreadS);
  const auto warped = [&](double t) {
    const double position = std::clamp(t / kWarpKnotS, 0.0, static_cast<double>(offsets.size()) - 1);
    const auto left = std::min(static_cast<std::size_t>(position), offsets.size() - 2);
    return t + std::lerp(offsets[left], offsets[left + 1], position - static_cast<double>(left));
  };
  for (PhoneSegment& phone : phones) {
    phone.start_s = warped(phone.start_s);
    phone.end_s = warped(phone.end_s);
    if (phone.closure) phone.closure = TimeSpan{warped(phone.closure->start_s), warped(phone.closure->end_s)};
  }
}

// How the emotional pose acts on one channel.
enum class PoseRule { plain, mouth, opens_lips };
PoseRule pose_rule(std::size_t c) {
  using namespace channel;
  const bool opens = c == kJawOpen || c == kMouthFunnel || (c >= kMouthUpperUp && c <= kMouthUpperUp + 1) ||
                     (c >= kMouthLowerDown && c <= kMouthLowerDown + 1) ||
                     (c >= kMouthStretch && c <= kMouthStretch + 1);
  if (opens) return PoseRule::opens_lips;
  return c >= kJawForward && c < kBrowDown ? PoseRule::mouth : PoseRule::plain;
}

// Gaze and the lids that follow it.
void look(ArkitFrame& w, float x_deg, float y_deg) {
  using namespace channel;
  const auto x = x_deg / static_cast<float>(kMaxHorizontalDeg),
             y = y_deg / static_cast<float>(kMaxVerticalDeg);
  for (const std::size_t eye : {kLeft, kRightEye}) {
    const float outward = eye == kLeft ? x : -x;
    w[eye + kLookOut] = std::max(0.0f, outward);
    w[eye + kLookIn] = std::max(0.0f, -outward);
    w[eye + kLookUp] = std::max(0.0f, y);
    w[eye + kLookDown] = std::max(0.0f, -y);
    w[eye + kEyeBlink] = std::clamp(-0.012f * y_deg, 0.0f, 0.35f);
    w[eye + kEyeWide] = std::clamp(0.008f * y_deg, 0.0f, 0.2f);
  }
}

void move_brows(ArkitFrame& w, const Speaker& speaker, double asymmetry, float raises, float drift) {
  using namespace channel;
  const auto rest = static_cast<float>(speaker.rest_brow);
  const float raise = raises + std::max(0.0f, drift);
  w[kBrowInnerUp] = raise + std::max(0.0f, rest);
  for (const std::size_t side : {kLeft, kRight}) {
    const auto q = static_cast<float>(side == kLeft ? 1 + asymmetry : 1 - asymmetry);
    w[kBrowOuterUp + side] = 0.72f * q * raise;
    w[kBrowDown + side] = std::max(0.0f, -drift) + std::max(0.0f, -rest);
  }
}

ArkitFrame face_at(const Parts& parts, const Speaker& speaker, std::size_t n) {
  using namespace channel;
  ArkitFrame w = mouth_pose(parts.mouth[n], parts.style);
  look(w, parts.gaze.x_deg[n], parts.gaze.y_deg[n]);
  move_brows(w, speaker, parts.style.asymmetry, parts.brows.raise[n], parts.brows.drift[n]);
  const float activity = parts.activity[n];
  for (const std::size_t side : {kLeft, kRight})
    w[kMouthSmile + side] += static_cast<float>(speaker.rest_smile);
  for (const std::size_t eye : {kLeft, kRightEye})
    w[eye + kEyeSquint] += static_cast<float>(speaker.squint_talk) * activity;

  const float closure = parts.mouth[n].closure;
  const float while_talking = 1 - 0.35f * activity;
  float smile = 0;
  for (std::size_t c = 0; c < kNumArkit; ++c) {
    const PoseRule rule = pose_rule(c);
    float e = std::min(1.0f, parts.expression.pose[c] * parts.expression.envelope[n]);
    if (rule != PoseRule::plain) e *= while_talking;
    if (rule == PoseRule::opens_lips) e *= 1 - closure;
    if (c == kMouthSmile) smile = e;
    w[c] = 1 - (1 - std::clamp(w[c], 0.0f, 1.0f)) * (1 - e);  // screen blend
  }
  w[kMouthClose] = mouth_close(closure, w[kJawOpen]);  // so that closures survive every emotion
  w[kMouthPucker] *= 1 - 0.4f * smile;
  for (float& value : w) value = std::clamp(value, 0.0f, 1.0f);
  return w;
}

Motion assemble(const Parts& parts, const Speaker& speaker) {
  Motion motion{MotionSpace::arkit, arkit_and_head_channels(), kCorpusFps, {}};
  motion.values.resize(parts.mouth.size() * motion.channels.size());
  for (std::size_t n = 0; n < parts.mouth.size(); ++n) {
    const auto frame = motion.frame(static_cast<std::int64_t>(n));
    const ArkitFrame face = face_at(parts, speaker, n);
    std::copy(face.begin(), face.end(), frame.begin());
    frame[kNumArkit] = parts.head.yaw_deg[n];
    frame[kNumArkit + 1] = parts.head.pitch_deg[n];
    frame[kNumArkit + 2] = parts.head.roll_deg[n];
  }
  return motion;
}

std::int64_t checked_frames(const Utterance& utterance, double intensity) {
  contract(utterance.seconds >= 0 && utterance.seconds <= 24 * 3600, "take: an utterance has 0 s ... 24 h");
  contract(intensity >= 0 && intensity <= 1, "take: intensity must be 0 ... 1");
  for (const PhoneSegment& phone : utterance.phones)
    contract(std::isfinite(phone.start_s) && std::isfinite(phone.end_s), "take: phone times must be finite");
  return num_motion_frames(utterance.seconds, kCorpusFps);
}

}  // namespace

Take draw_take(const Utterance& utterance, const Speaker& speaker, Emotion emotion, double intensity,
               std::uint64_t seed) {
  const std::int64_t num_frames = checked_frames(utterance, intensity);
  Rng latent = stream_of(seed, Stream::latent);
  const double z0 = latent.normal(), z1 = latent.normal(), z2 = latent.normal();

  Parts parts;
  parts.activity = speech_activity(utterance, num_frames);
  parts.style = articulation_style(speaker, emotion, intensity);
  Rng articulation = stream_of(seed, Stream::articulation);
  parts.style.jaw *= std::exp(0.14 * z0);
  parts.style.lip *= std::exp(0.14 * z1);
  parts.style.round *= std::exp(0.10 * z1);
  parts.style.width *= articulation.log_normal(0, 0.06);
  parts.style.press *= articulation.log_normal(0, 0.12);
  std::vector<PhoneSegment> phones = utterance.phones;
  warp_times(phones, utterance.seconds, articulation);
  std::vector<double> gains(phones.size());
  for (double& gain : gains) gain = articulation.log_normal(0, kPhoneGainSpread);
  parts.mouth = articulate(phones, parts.style, num_frames, gains);

  Rng expression = stream_of(seed, Stream::expression);
  const double strength = intensity * std::exp(0.15 * z2 - 0.011);
  parts.expression = express(speaker, emotion, strength, slow_walk(0.10, 1.5, num_frames, expression));

  Rng gaze = stream_of(seed, Stream::gaze), brows = stream_of(seed, Stream::brows);
  Rng head = stream_of(seed, Stream::head), blinks = stream_of(seed, Stream::blinks);
  parts.gaze = draw_gaze(speaker, num_frames, gaze);
  parts.brows = draw_brows(speaker, utterance, num_frames, brows);
  parts.head = draw_head(speaker, utterance, parts.gaze, head);

  Take take;
  take.latents = {static_cast<float>(z0), static_cast<float>(z1), static_cast<float>(z2)};
  take.without_blinks = assemble(parts, speaker);
  take.raises = std::move(parts.brows.raises);
  std::fill(parts.brows.raise.begin(), parts.brows.raise.end(), 0.0f);
  take.without_events = assemble(parts, speaker);
  take.blinks = draw_blinks({.blinks_per_minute = speaker.blinks_per_minute *
                                                  scaled_gain(emotion_gains(emotion).blink_rate, intensity),
                             .seconds = utterance.seconds,
                             .pauses = pauses_of(utterance),
                             .shifts = parts.gaze.shifts},
                            blinks);
  take.motion = take.without_blinks;
  apply_blinks(take.motion, take.blinks);
  return take;
}

Motion plain_performance(const Utterance& utterance, const Speaker& speaker, Emotion emotion,
                         double intensity) {
  const std::int64_t num_frames = checked_frames(utterance, intensity);
  const std::vector<float> still(static_cast<std::size_t>(num_frames), 0.0f);
  Parts parts;
  parts.activity = speech_activity(utterance, num_frames);
  parts.style = articulation_style(speaker, emotion, intensity);
  parts.mouth = articulate(utterance.phones, parts.style, num_frames);
  parts.expression = express(speaker, emotion, intensity, still);
  parts.gaze = {still, still, {}};
  parts.brows = {still, still, {}};
  parts.head = {still, still, still};
  return assemble(parts, speaker);
}

Motion default_performance(const Utterance& utterance) {
  return plain_performance(utterance, Speaker{}, Emotion::neutral, 1);
}

Motion mean_performance(const Utterance& utterance, const Speaker& speaker, Emotion emotion, double intensity,
                        std::uint64_t seed, int count) {
  contract(count > 0, "mean_performance: count must be positive");
  Motion mean;
  std::vector<double> sum;
  for (int i = 0; i < count; ++i) {
    Take take =
        draw_take(utterance, speaker, emotion, intensity, hash_combine(seed, static_cast<std::uint64_t>(i)));
    sum.resize(take.motion.values.size());
    for (std::size_t v = 0; v < sum.size(); ++v) sum[v] += take.motion.values[v];
    mean = std::move(take.motion);
  }
  for (std::size_t v = 0; v < sum.size(); ++v) mean.values[v] = static_cast<float>(sum[v] / count);
  return mean;
}

std::uint64_t take_seed(std::uint64_t corpus_seed, std::string_view item_id, std::uint64_t take_index) {
  return hash_combine(hash64(item_id, corpus_seed), take_index);
}

}  // namespace mien
