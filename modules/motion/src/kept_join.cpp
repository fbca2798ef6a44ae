#include "mien/motion/kept_join.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "join_ease.h"
#include "mien/base/contract.h"

namespace mien {
namespace {

// The longest fade of a channel, in seconds: lips must soon be where the speech has them, the head may take
// its time.
double longest_fade(const Motion& motion, std::size_t c) {
  constexpr double kUsual = 0.25;
  if (motion.space == MotionSpace::vertices) return kUsual;
  const std::string& name = motion.channels[c];
  if (name.starts_with("head")) return 2;
  if (name.starts_with("brow") || name.starts_with("eyeLook")) return 0.5;
  return name.starts_with("eye") ? 0.3 : kUsual;
}

// The 95th percentile of a channel's second differences in the motion that is edited.
double usual_acceleration(const KeptValues& kept, std::int64_t c) {
  std::vector<double> all;
  for (std::int64_t n = 1; n + 1 < kept.num_frames(); ++n)
    all.push_back(std::abs(static_cast<double>(kept.value(n - 1, c)) -
                           2 * static_cast<double>(kept.value(n, c)) +
                           static_cast<double>(kept.value(n + 1, c))));
  if (all.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(all.size() - 1));
  std::nth_element(all.begin(), all.begin() + at, all.end());
  return all[static_cast<std::size_t>(at)];
}

// Quintics on 0 ... 1 with all values, slopes and accelerations zero at both ends but one: H0(0) = 1, H1'(0)
// = 1.
double fade_value(double t) { return 1 - t * t * t * (10 - t * (15 - 6 * t)); }
double fade_slope(double t) { return t - t * t * t * (6 - t * (8 - 3 * t)); }
constexpr double kValuePeak = 5.78, kSlopePeak = 3.94;  // their largest second derivatives

// Frames after which a fade of `value` and `slope` a frame accelerates by no more than `limit` a frame
// squared.
double fade_length(double value, double slope, double limit) {
  const double v = kSlopePeak * std::abs(slope);
  return (v + std::sqrt(v * v + 4 * kValuePeak * std::abs(value) * limit)) / (2 * limit);
}

// Leads one channel of `made` away from its kept frames.
class ChannelJoin {
 public:
  ChannelJoin(const KeptValues& kept, const Motion& made, std::int64_t c)
      : kept_(kept),
        made_(made),
        c_(c),
        is_gaze_(made.space != MotionSpace::vertices &&
                 made.channels[static_cast<std::size_t>(c)].starts_with("eyeLook")),
        usual_(usual_acceleration(kept, c)),
        limit_(kShare * usual_),
        longest_(longest_fade(made, static_cast<std::size_t>(c)) * made.fps) {}

  // What to add to what was made in the free frames first ... end - 1, of which those around are kept.
  [[nodiscard]] std::vector<double> corrections(std::int64_t first, std::int64_t end) const {
    std::vector<double> sum(static_cast<std::size_t>(end - first));
    const auto length = static_cast<double>(end - first + 1);
    if (first > 0) add_fade(first - 1, -1, length, sum);
    if (end < kept_.num_frames()) {
      std::reverse(sum.begin(), sum.end());
      add_fade(end, 1, length, sum);
      std::reverse(sum.begin(), sum.end());
    }
    return sum;
  }

  // Eases the joins of a free stretch of `joined`, of which everything else is final.
  void ease(std::int64_t first, std::int64_t end, Motion& joined) const {
    const auto reach =
        std::min(static_cast<std::int64_t>(std::lround(kEase * joined.fps)), (end - first) / 2 - 2);
    if (usual_ <= 0 || reach < 2) return;
    if (first >= 2 && kept_.keeps(first - 2, c_)) ease_from(first - 1, 1, reach, joined);
    if (end + 1 < kept_.num_frames() && kept_.keeps(end + 1, c_)) ease_from(end, -1, reach, joined);
  }

 private:
  // From the kept frame `join` on, in the direction of what was made.
  void ease_from(std::int64_t join, std::int64_t step, std::int64_t reach, Motion& joined) const {
    const auto at = [&](std::int64_t i) -> float& {
      return joined.frame(join + step * (i - 1))[static_cast<std::size_t>(c_)];
    };
    std::vector<double> values(static_cast<std::size_t>(reach + 4));
    for (std::int64_t i = 0; i < reach + 4; ++i)
      values[static_cast<std::size_t>(i)] = i < 2 ? kept(join + step * (i - 1)) : static_cast<double>(at(i));
    const auto before = values;
    // A join within what is rough in the motion itself need not be smoother than that.
    const auto limit_at = [&](std::int64_t n) {
      const bool has_both = n > 0 && n + 1 < kept_.num_frames();
      return std::max(usual_, has_both ? std::abs(kept(n - 1) - 2 * kept(n) + kept(n + 1)) : 0.0);
    };
    ease_join(values, kEaseShare * limit_at(join), kEaseShare * limit_at(join + step), kEaseShare * usual_);
    for (std::int64_t i = 2; i < reach + 2; ++i) {
      const double change = values[static_cast<std::size_t>(i)] - before[static_cast<std::size_t>(i)];
      at(i) = static_cast<float>(static_cast<double>(at(i)) + change);
    }
  }
  [[nodiscard]] double made(std::int64_t n) const {
    return static_cast<double>(made_.frame(n)[static_cast<std::size_t>(c_)]);
  }
  [[nodiscard]] double kept(std::int64_t n) const { return static_cast<double>(kept_.value(n, c_)); }

  // The fade that begins at kept frame `join`; kept frames go on in the direction `outward`.
  void add_fade(std::int64_t join, std::int64_t outward, double length, std::vector<double>& sum) const {
    const double value = kept(join) - made(join);
    const std::int64_t before = join + outward;
    double slope = 0;
    if (before >= 0 && before < kept_.num_frames() && kept_.keeps(before, c_))
      slope = value - (kept(before) - made(before));
    const double wanted =
        limit_ > 0 ? std::max(fade_length(is_gaze_ ? 0 : value, slope, limit_), kShortest) : longest_;
    const double frames = std::min({wanted, longest_, length});
    // Eyes do not drift from one place to another, they leap: a little away from the join.
    const double hold = is_gaze_ ? std::min(kGazeHold * made_.fps, length / 3) : 0;
    const double span = is_gaze_ ? std::min(kGazeLeap * made_.fps, length - hold) : frames;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const auto k = static_cast<double>(i + 1);
      sum[i] += value * fade_value(std::clamp((k - hold) / span, 0.0, 1.0)) +
                slope * frames * fade_slope(std::min(k / frames, 1.0));
    }
  }

  const KeptValues& kept_;
  const Motion& made_;
  std::int64_t c_;
  // What is made has accelerations of its own: a fade may add half of what is usual.
  static constexpr double kShare = 0.5, kShortest = 3;
  static constexpr double kGazeHold = 0.1, kGazeLeap = 0.08;  // seconds
  static constexpr double kEase = 0.12;                       // seconds that easing may move
  // Of a channel's usual acceleration: several channels at their limit together are rougher than usual.
  static constexpr double kEaseShare = 0.7;
  bool is_gaze_;
  double usual_, limit_, longest_;  // a frame squared twice; frames
};

double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

// Keeps lips closed where the model closes them.
class Contact {
 public:
  explicit Contact(const Motion& motion) : give_way_(0.05 * motion.fps) {
    if (motion.space != MotionSpace::arkit) return;
    jaw_ = motion.find("jawOpen");
    close_ = motion.find("mouthClose");
    for (const char* name : {"mouthLowerDownLeft", "mouthLowerDownRight", "mouthUpperUpLeft",
                             "mouthUpperUpRight", "mouthFunnel"})
      if (const auto c = motion.find(name)) openers_.push_back(*c);
  }

  // made: what the model made. joined: the result so far, which changes.
  void apply(const KeptValues& kept, const Motion& made, Motion& joined) const {
    if (!jaw_ || !close_) return;
    const std::vector<double> jaw_room = room(kept, *jaw_), close_room = room(kept, *close_);
    std::vector<std::vector<double>> opener_room;
    for (const std::int64_t c : openers_) opener_room.push_back(room(kept, c));
    for (std::int64_t n = 0; n < kept.num_frames(); ++n) {
      const auto at = static_cast<std::size_t>(n);
      const auto from = made.frame(n);
      const auto to = joined.frame(n);
      const auto value = [&](std::int64_t c) -> float& { return to[static_cast<std::size_t>(c)]; };
      const auto of_model = [&](std::int64_t c) { return from[static_cast<std::size_t>(c)]; };
      const double gap = static_cast<double>(of_model(*jaw_)) - static_cast<double>(of_model(*close_));
      const double closed = smooth((kOpen - gap) / kOpen);
      if (closed <= 0) continue;
      const auto lead = [&](std::int64_t c, double target, double share) {
        float& v = value(c);
        v = static_cast<float>(static_cast<double>(v) + share * (target - static_cast<double>(v)));
      };
      const double pressed = std::min(gap, 0.0);
      if (close_room[at] > 0)
        lead(*close_, std::max<double>(value(*close_), static_cast<double>(value(*jaw_)) - pressed),
             closed * close_room[at]);
      else
        lead(*jaw_,
             std::min<double>(value(*jaw_), static_cast<double>(value(*close_)) + std::max(pressed, -0.02)),
             closed * jaw_room[at]);
      for (std::size_t i = 0; i < openers_.size(); ++i)
        lead(openers_[i], std::min<double>(value(openers_[i]), of_model(openers_[i])),
             closed * opener_room[i][at]);
    }
  }

 private:
  static constexpr double kOpen = 0.04;  // of jawOpen - mouthClose: lips that part count as open from here on

  // 0 in kept frames of a channel, rising to 1 over the time within which contact gives way to a join. [N]
  [[nodiscard]] std::vector<double> room(const KeptValues& kept, std::int64_t c) const {
    const std::int64_t num_frames = kept.num_frames();
    std::vector<double> distance(static_cast<std::size_t>(num_frames));
    double run = 2 * give_way_;
    for (std::int64_t n = 0; n < num_frames; ++n)
      distance[static_cast<std::size_t>(n)] = run = kept.keeps(n, c) ? 0 : run + 1;
    run = 2 * give_way_;
    for (std::int64_t n = num_frames - 1; n >= 0; --n) {
      run = kept.keeps(n, c) ? 0 : run + 1;
      double& d = distance[static_cast<std::size_t>(n)];
      d = std::min(d, run);
      d = d == 0 ? 0 : smooth(d / give_way_);
    }
    return distance;
  }

  double give_way_;  // frames
  std::optional<std::int64_t> jaw_, close_;
  std::vector<std::int64_t> openers_;
};

}  // namespace

double join_roughness(const KeptValues& kept, const Motion& joined, FrameRange stretch) {
  constexpr std::int64_t kAround = 3;  // frames to either side of a join
  double sum = 0;
  for (std::int64_t c = 0; c < kept.num_channels(); ++c) {
    const double usual = std::max(usual_acceleration(kept, c), 1e-4);
    for (const std::int64_t join : {stretch.first, stretch.end})
      for (std::int64_t n = std::max<std::int64_t>(join - kAround, 1);
           n < std::min(join + kAround, kept.num_frames() - 1) && join > 0 && join < kept.num_frames(); ++n) {
        const auto value = [&](std::int64_t at) {
          return static_cast<double>(joined.frame(at)[static_cast<std::size_t>(c)]);
        };
        const double ratio = (value(n - 1) - 2 * value(n) + value(n + 1)) / usual;
        sum += ratio * ratio;
      }
  }
  return sum;
}

void join_kept(const KeptValues& kept, Motion& made) {
  const std::int64_t num_frames = kept.num_frames(), width = kept.num_channels();
  contract(made.num_frames() == num_frames && made.num_channels() == width, "join_kept: sizes disagree");
  Motion joined = made;
  for (std::int64_t c = 0; c < width; ++c) {
    const ChannelJoin channel(kept, made, c);
    for (std::int64_t first = 0; first < num_frames;) {
      if (kept.keeps(first, c)) {
        ++first;
        continue;
      }
      std::int64_t end = first;
      while (end < num_frames && !kept.keeps(end, c)) ++end;
      const std::vector<double> corrections = channel.corrections(first, end);
      for (std::int64_t n = first; n < end; ++n) {
        float& v = joined.frame(n)[static_cast<std::size_t>(c)];
        v = static_cast<float>(static_cast<double>(v) + corrections[static_cast<std::size_t>(n - first)]);
      }
      channel.ease(first, end, joined);
      const bool is_coefficient =
          made.space == MotionSpace::arkit && !made.channels[static_cast<std::size_t>(c)].starts_with("head");
      for (std::int64_t n = first; n < end && is_coefficient; ++n) {
        const float own = made.frame(n)[static_cast<std::size_t>(c)];
        float& v = joined.frame(n)[static_cast<std::size_t>(c)];
        v = std::clamp(v, std::min(own, 0.0f), std::max(own, 1.0f));
      }
      first = end;
    }
  }
  // The kept frames first: contact looks at a kept jaw or mouthClose.
  for (std::int64_t n = 0; n < num_frames; ++n) kept.paste(n, joined.frame(n));
  Contact(made).apply(kept, made, joined);
  made = std::move(joined);
}

}  // namespace mien
