#include <cmath>
#include <numbers>

#include "mien/corpus/articulation.h"
#include "mien/corpus/gestures.h"
#include "time_shape.h"

namespace mien {
namespace {

constexpr double kContactSpread = 0.6, kAwaySpread = 0.5;  // sd of the logarithm of the durations
constexpr double kMaxAwayDeg = 27, kVerticalScale = 0.7;
constexpr double kFixationalDeg = 0.5;

struct Point {
  double x = 0, y = 0;
};
double distance(const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.y - b.y); }

// One jump of the eyes; afterwards they rest at `to`.
struct Saccade {
  double start_s, seconds;
  Point from, to;
};
double saccade_seconds(double deg) { return 0.021 + 0.0022 * deg; }

Point draw_away(double mean_deg, Rng& rng) {
  struct Direction {
    double probability, x, y;
  };
  constexpr double kDiagonal = 1 / std::numbers::sqrt2;
  static constexpr Direction kDirections[] = {{0.16, -1, 0},
                                              {0.16, 1, 0},
                                              {0.18, 0, 1},
                                              {0.21, 0, -1},
                                              {0.08, -kDiagonal, kDiagonal},
                                              {0.08, kDiagonal, kDiagonal},
                                              {0.065, -kDiagonal, -kDiagonal},
                                              {0.065, kDiagonal, -kDiagonal}};
  const double amplitude = std::min(kMaxAwayDeg, rng.exponential(mean_deg));
  double u = rng.uniform();
  const Direction* chosen = kDirections;
  for (const Direction& d : kDirections) {
    chosen = &d;
    if (u < d.probability) break;
    u -= d.probability;
  }
  return {amplitude * chosen->x, amplitude * kVerticalScale * chosen->y};
}

class GazeWalk {
 public:
  GazeWalk(const Speaker& speaker, Rng& rng)
      : speaker_(speaker), rng_(rng), contact_log_(std::log(2.2 * std::pow(0.3 / speaker.gaze_away, 0.8))) {}

  // Alternates contact and away from before time zero until `end_s`.
  void run(double end_s) {
    const double contact_mean = std::exp(contact_log_ + kContactSpread * kContactSpread / 2);
    const double away_mean = 0.9 * std::exp(kAwaySpread * kAwaySpread / 2);
    bool is_contact = rng_.chance(contact_mean / (contact_mean + away_mean));
    double dwell = draw_dwell(is_contact);
    double t = -rng_.uniform() * dwell;
    while (t < end_s) {
      const Point target = is_contact ? Point{} : draw_away(speaker_.gaze_deg, rng_);
      const double deg = distance(here_, target);
      jump(t, target);
      if (t >= 0) shifts.push_back({t + saccade_seconds(deg), deg});
      fixate(t + saccade_seconds(deg), t + dwell, target);
      t += dwell;
      is_contact = !is_contact;
      dwell = draw_dwell(is_contact);
    }
  }

  std::vector<Saccade> saccades;
  std::vector<GazeShift> shifts;

 private:
  double draw_dwell(bool is_contact) {
    return is_contact ? rng_.log_normal(contact_log_, kContactSpread)
                      : rng_.log_normal(std::log(0.9), kAwaySpread);
  }

  void jump(double t, const Point& to) {
    saccades.push_back({t, saccade_seconds(distance(here_, to)), here_, to});
    here_ = to;
  }

  // Small jumps around the target; the next large one leaves from where the last ended.
  void fixate(double start_s, double end_s, const Point& target) {
    for (double t = start_s;;) {
      t += rng_.exponential(0.8) + 0.15;
      if (t + saccade_seconds(1) > end_s) return;
      const double dx = rng_.normal(0, kFixationalDeg), dy = rng_.normal(0, kFixationalDeg);
      jump(t, {target.x + dx, target.y + dy});
    }
  }

  const Speaker& speaker_;
  Rng& rng_;
  double contact_log_;
  Point here_;
};

}  // namespace

GazeTrack draw_gaze(const Speaker& speaker, std::int64_t num_frames, Rng& rng) {
  GazeWalk walk(speaker, rng);
  walk.run(static_cast<double>(num_frames) / kCorpusFps);
  GazeTrack track;
  track.shifts = std::move(walk.shifts);
  track.x_deg.resize(static_cast<std::size_t>(num_frames));
  track.y_deg.resize(static_cast<std::size_t>(num_frames));
  std::size_t next = 0;
  for (std::size_t n = 0; n < track.x_deg.size(); ++n) {
    const double t = static_cast<double>(n) / kCorpusFps;
    while (next < walk.saccades.size() && walk.saccades[next].start_s <= t) ++next;
    const Saccade& s = walk.saccades[next - 1];  // the first one starts before or at time zero
    const double u = smooth_step((t - s.start_s) / s.seconds);
    track.x_deg[n] = static_cast<float>(s.from.x + u * (s.to.x - s.from.x));
    track.y_deg[n] = static_cast<float>(s.from.y + u * (s.to.y - s.from.y));
  }
  return track;
}

}  // namespace mien
