#include <algorithm>
#include <cmath>

#include "mien/corpus/articulation.h"
#include "mien/corpus/gestures.h"
#include "time_shape.h"

namespace mien {
namespace {

constexpr double kQuestionProbability = 0.6, kQuestionGain = 1.3;
constexpr double kYawOfGaze = 0.075;  // the head follows the eyes a little

void add(std::vector<float>& track, const Bump& bump, double amplitude) {
  for_each_sample(bump, kCorpusFps, static_cast<std::int64_t>(track.size()),
                  [&](std::size_t n, double value) { track[n] += static_cast<float>(amplitude * value); });
}

double end_of_speech(const Utterance& utterance) {
  double end = 0;
  for (const PhoneSegment& phone : utterance.phones)
    if (!phone.is_pause()) end = std::max(end, phone.end_s);
  return end;
}

}  // namespace

BrowTrack draw_brows(const Speaker& speaker, const Utterance& utterance, std::int64_t num_frames, Rng& rng) {
  BrowTrack brows;
  brows.drift = slow_walk(0.018, 2.5, num_frames, rng);
  brows.raise.resize(static_cast<std::size_t>(num_frames));
  const auto draw_amplitude = [&] { return speaker.brow_amplitude * rng.log_normal(0, 0.3); };
  for (const double accent : utterance.accents_s) {
    if (!rng.chance(speaker.brow_probability)) continue;
    const double amplitude = draw_amplitude();
    const double centre = accent + rng.normal(-0.020, 0.040);
    const double rise = std::clamp(rng.normal(0.180, 0.040), 0.100, 0.300);
    const double fall = std::clamp(rng.normal(0.350, 0.080), 0.200, 0.600);
    add(brows.raise, {centre - 0.040, centre + 0.040, rise, fall}, amplitude);
    brows.raises.push_back({centre, amplitude});
  }
  if (utterance.is_question && rng.chance(kQuestionProbability)) {
    const double amplitude = kQuestionGain * draw_amplitude();
    const double end = end_of_speech(utterance);  // the raise is held over the last 0.3 s of speech
    add(brows.raise, {end - 0.300, end, 0.250, 0.400}, amplitude);
    brows.raises.push_back({end - 0.150, amplitude});
  }
  return brows;
}

HeadTrack draw_head(const Speaker& speaker, const Utterance& utterance, const GazeTrack& gaze, Rng& rng) {
  const auto num_frames = static_cast<std::int64_t>(gaze.x_deg.size());
  HeadTrack head;
  head.yaw_deg = slow_walk(1.2 * speaker.head_deg, 1.6, num_frames, rng);
  head.pitch_deg = slow_walk(speaker.head_deg, 1.3, num_frames, rng);
  head.roll_deg = slow_walk(0.6 * speaker.head_deg, 1.8, num_frames, rng);
  for (std::size_t n = 0; n < gaze.x_deg.size(); ++n)
    head.yaw_deg[n] += static_cast<float>(kYawOfGaze) * gaze.x_deg[n];
  for (const double accent : utterance.accents_s) {
    if (!rng.chance(speaker.nod_probability)) continue;
    const double amplitude = speaker.nod_deg * rng.log_normal(0, 0.3);
    const double centre = accent + rng.normal(0.030, 0.050);
    add(head.pitch_deg, {centre - 0.015, centre + 0.015, 0.160, 0.260}, -amplitude);
  }
  return head;
}

std::vector<float> speech_activity(const Utterance& utterance, std::int64_t num_frames) {
  std::vector<float> active(static_cast<std::size_t>(num_frames), 1.0f);
  for (const TimeSpan& pause : pauses_of(utterance)) {
    const auto first = static_cast<std::int64_t>(std::ceil(pause.start_s * kCorpusFps));
    const auto end = std::min(num_frames, static_cast<std::int64_t>(std::ceil(pause.end_s * kCorpusFps)));
    for (std::int64_t n = std::max<std::int64_t>(0, first); n < end; ++n)
      active[static_cast<std::size_t>(n)] = 0;
  }
  return hann_smoothed(active, 31);
}

}  // namespace mien
