#include "mien/motion/kept_join.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "join_ease.h"
#include "mien/base/contract.h"
#include "usual_acceleration.h"

namespace mien {
namespace {

bool is_gaze(const Motion& motion, std::size_t c) {
  return motion.space != MotionSpace::vertices && motion.channels[c].starts_with("eyeLook");
}

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

// Seconds from a join within which easing moves frames, as long as that is enough; and within which lips need
// not meet where the model closes them.
constexpr double kEaseNear = 0.12, kContactGivesWay = 0.05;

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
  ChannelJoin(const KeptValues& kept, const UsualAcceleration& usual, const Motion& made, std::int64_t c)
      : kept_(kept),
        usual_(usual),
        made_(made),
        c_(c),
        is_gaze_(is_gaze(made, static_cast<std::size_t>(c))),
        is_coefficient_(made.space == MotionSpace::arkit &&
                        !made.channels[static_cast<std::size_t>(c)].starts_with("head")),
        limit_(kShare * usual.of_channel(c)),
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

  // Eases the joins of a free stretch of `joined`, of which everything else is final. Frames up to `near`
  // seconds from a join move, up to `far` where that is not enough.
  void ease(std::int64_t first, std::int64_t end, double near, double far, Motion& joined) const {
    constexpr std::int64_t kLeast = 2;  // frames on either side of a join decide its accelerations
    const std::int64_t half = (end - first) / 2;
    if (half < kLeast) return;
    const auto frames = [&](double seconds) {
      return std::clamp(static_cast<std::int64_t>(std::lround(seconds * joined.fps)), kLeast,
                        std::max(half - 2, kLeast));
    };
    const auto ease_from = [&](std::int64_t join, std::int64_t step) {
      std::vector<double> before, best;
      double least = std::numeric_limits<double>::infinity();
      for (std::int64_t reach = frames(near);; reach = std::min(2 * reach, frames(far))) {
        std::vector<double> eased = beside(join, step, reach, joined), now = eased;
        if (const double excess = ease_beside(join, step, eased); excess < least)
          least = excess, best = std::move(eased), before = std::move(now);
        if (least <= 0 || reach >= frames(far)) break;
      }
      // Adding the change keeps the bits of what did not move.
      for (std::size_t i = 2; i + 2 < best.size(); ++i) {
        float& v = at(join, step, i, joined);
        v = static_cast<float>(static_cast<double>(v) + (best[i] - before[i]));
      }
    };
    if (first >= 2 && kept_.keeps(first - 2, c_)) ease_from(first - 1, 1);
    if (end + 1 < kept_.num_frames() && kept_.keeps(end + 1, c_)) ease_from(end, -1);
  }

  void keep_in_range(std::int64_t first, std::int64_t end, Motion& joined) const {
    for (std::int64_t n = first; n < end; ++n) {
      float& v = joined.frame(n)[static_cast<std::size_t>(c_)];
      v = static_cast<float>(std::clamp(static_cast<double>(v), low(n), high(n)));
    }
  }

 private:
  // Of frame n: 0 ... 1 for coefficients, farther where the model or the motion itself goes there.
  [[nodiscard]] double low(std::int64_t n) const {
    return is_coefficient_ ? std::min({made(n), kept(n), 0.0}) : -kNone;
  }
  [[nodiscard]] double high(std::int64_t n) const {
    return is_coefficient_ ? std::max({made(n), kept(n), 1.0}) : kNone;
  }
  // The value i of those beside a join: 1 is the last kept one.
  float& at(std::int64_t join, std::int64_t step, std::size_t i, Motion& joined) const {
    return joined.frame(join + step * (static_cast<std::int64_t>(i) - 1))[static_cast<std::size_t>(c_)];
  }
  // Two kept values, `reach` that may move and two behind them, from the join on in the direction of what was
  // made.
  std::vector<double> beside(std::int64_t join, std::int64_t step, std::int64_t reach, Motion& joined) const {
    std::vector<double> values = {kept(join - step), kept(join)};
    while (std::ssize(values) < reach + 4)
      values.push_back(static_cast<double>(at(join, step, values.size(), joined)));
    return values;
  }
  double ease_beside(std::int64_t join, std::int64_t step, std::vector<double>& values) const {
    std::vector<double> lows, highs;
    for (std::int64_t i = 0; i < std::ssize(values); ++i) {
      lows.push_back(low(join + step * (i - 1)));
      highs.push_back(high(join + step * (i - 1)));
    }
    return ease_join(values, {.at_kept = usual_.limit(join, c_),
                              .at_free = usual_.limit(join + step, c_),
                              .elsewhere = kEaseShare * usual_.of_channel(c_),
                              .low = lows,
                              .high = highs});
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
  const UsualAcceleration& usual_;
  const Motion& made_;
  std::int64_t c_;
  // What is made has accelerations of its own: a fade may add half of what is usual.
  static constexpr double kShare = 0.5, kShortest = 3;
  static constexpr double kGazeHold = 0.1, kGazeLeap = 0.08;  // seconds
  static constexpr double kEaseShare = 0.7;  // of a channel's usual acceleration, behind a join
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  bool is_gaze_, is_coefficient_;
  double limit_, longest_;  // a frame squared; frames
};

double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

// Keeps lips closed where the model closes them.
class Contact {
 public:
  explicit Contact(const Motion& motion) : give_way_(kContactGivesWay * motion.fps) {
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
  // What is made is eased farther, and shows there how far it was from what is kept. Eyes leap there anyway.
  const auto behind = std::max(kAround, static_cast<std::int64_t>(std::lround(kEaseNear * joined.fps)) + 2);
  const UsualAcceleration usual(kept, joined);
  double sum = 0;
  for (std::int64_t c = 0; c < kept.num_channels(); ++c) {
    const double unit = std::max(usual.of_channel(c), 1e-4);
    const std::int64_t inside = is_gaze(joined, static_cast<std::size_t>(c)) ? kAround : behind;
    for (const auto& [join, before, after] :
         {std::array{stretch.first, kAround, inside}, std::array{stretch.end, inside, kAround}})
      for (std::int64_t n = std::max<std::int64_t>(join - before, 1);
           n < std::min(join + after, kept.num_frames() - 1) && join > 0 && join < kept.num_frames(); ++n) {
        const auto value = [&](std::int64_t at) {
          return static_cast<double>(joined.frame(at)[static_cast<std::size_t>(c)]);
        };
        const double ratio = (value(n - 1) - 2 * value(n) + value(n + 1)) / unit;
        sum += ratio * ratio;
      }
  }
  return sum;
}

void join_kept(const KeptValues& kept, Motion& made) {
  const std::int64_t num_frames = kept.num_frames(), width = kept.num_channels();
  contract(made.num_frames() == num_frames && made.num_channels() == width, "join_kept: sizes disagree");
  Motion joined = made;
  const UsualAcceleration usual(kept, made);
  const auto each_stretch = [&](const auto& work) {
    for (std::int64_t c = 0; c < width; ++c) {
      const ChannelJoin channel(kept, usual, made, c);
      for (std::int64_t first = 0, end = 0; first < num_frames; first = end) {
        end = first + 1;
        if (kept.keeps(first, c)) continue;
        while (end < num_frames && !kept.keeps(end, c)) ++end;
        work(channel, static_cast<std::size_t>(c), first, end);
      }
    }
  };
  each_stretch([&](const ChannelJoin& channel, std::size_t c, std::int64_t first, std::int64_t end) {
    const std::vector<double> corrections = channel.corrections(first, end);
    for (std::int64_t n = first; n < end; ++n) {
      float& v = joined.frame(n)[c];
      v = static_cast<float>(static_cast<double>(v) + corrections[static_cast<std::size_t>(n - first)]);
    }
    channel.ease(first, end, kEaseNear, longest_fade(made, c), joined);
    channel.keep_in_range(first, end, joined);
  });
  // The kept frames first: contact looks at a kept jaw or mouthClose.
  for (std::int64_t n = 0; n < num_frames; ++n) kept.paste(n, joined.frame(n));
  Contact(made).apply(kept, made, joined);
  // Where contact moves what is beside a join, it gives way.
  each_stretch([&](const ChannelJoin& channel, std::size_t, std::int64_t first, std::int64_t end) {
    channel.ease(first, end, kContactGivesWay, kContactGivesWay, joined);
    channel.keep_in_range(first, end, joined);
  });
  made = std::move(joined);
}

}  // namespace mien
