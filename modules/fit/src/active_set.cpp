#include "active_set.h"

#include <algorithm>
#include <cmath>

namespace mien {
namespace {

constexpr int kMaxRounds = 12, kMaxPasses = 8;
// Relative to the mean diagonal of P, which is 1, and to a box of about 1.
constexpr double kPenalty = 1e7;
constexpr double kExact = 1e-13;      // of the gradient and of the equations
constexpr double kWrongSide = 1e-12;  // a limit broken, or a multiplier below zero, by more than this

// Limits of one kind (box or change) of which either the lower or the upper may hold.
struct Sides {
  std::vector<signed char> held;  // -1 the lower, +1 the upper, 0 neither
  std::vector<double> miss;       // distance from the held limit, kept apart so that it has its own digits
  std::vector<double> pull;       // its multiplier, > 0 when it pushes inwards

  void start(std::size_t count) {
    held.assign(count, 0);
    miss.assign(count, 0.0);
    pull.assign(count, 0.0);
  }
  void hold(std::size_t i, int side, double distance, double multiplier) {
    held[i] = static_cast<signed char>(side);
    miss[i] = side == 0 ? 0 : distance;
    pull[i] = side == 0 ? 0 : multiplier;
  }
};

class ActiveSet {
 public:
  ActiveSet(const ScaledQp& problem, FrameChain& chain, const std::vector<double>& x,
            const Multipliers& multipliers)
      : problem_(problem), chain_(chain), k_(static_cast<std::size_t>(problem.num_channels)), x_(x) {
    const std::size_t pairs = problem.num_pairs();
    box_.start(x.size());
    rate_.start(pairs);
    for (std::size_t i = 0; i < x.size(); ++i)
      choose(box_, i, x[i] - problem.lower, problem.upper - x[i], multipliers.below[i], multipliers.above[i]);
    for (std::size_t i = 0; i < pairs; ++i) {
      const double step = x[i + k_] - x[i];
      choose(rate_, i, step + problem.max_change, problem.max_change - step, multipliers.falling[i],
             multipliers.rising[i]);
    }
    signed_.below.assign(x.size(), 0.0);
    signed_.above.assign(x.size(), 0.0);
    signed_.rising.assign(pairs, 0.0);
    signed_.falling.assign(pairs, 0.0);
    gradient_.resize(x.size());
    move_.resize(x.size());
    ties_.assign(x.size() > k_ ? x.size() - k_ : 0, 0.0);
    change_.resize(ties_.size());
    weights_.resize(x.size());
  }

  // Solves with the held limits as equations. False when the system cannot be factored.
  bool solve() {
    for (std::size_t i = 0; i < x_.size(); ++i) weights_[i] = box_.held[i] != 0 ? kPenalty : 0;
    for (std::size_t i = 0; i < rate_.held.size(); ++i) ties_[i] = rate_.held[i] != 0 ? kPenalty : 0;
    if (!chain_.factor(weights_, ties_)) return false;
    measure();
    for (int pass = 0; pass < kMaxPasses && worst_ > kExact; ++pass) {
      const double before = worst_;
      step();
      measure();
      if (!(worst_ < 0.5 * before)) break;  // rounding
    }
    return std::isfinite(worst_);
  }

  // Moves limits to the side where they belong; how many, and by how much they were wrong.
  std::size_t change_sides(double& wrong) {
    std::size_t count = 0;
    wrong = 0;
    const auto check = [&](Sides& sides, std::size_t i, double above_lower, double below_upper) {
      const double breach = std::max(-above_lower, -below_upper);
      if (sides.held[i] != 0 && sides.pull[i] < -kWrongSide) {
        wrong = std::max(wrong, -sides.pull[i]);
        sides.hold(i, 0, 0, 0);
        ++count;
      } else if (sides.held[i] == 0 && breach > kWrongSide) {
        wrong = std::max(wrong, breach);
        sides.hold(i, above_lower < below_upper ? -1 : 1, std::min(above_lower, below_upper), 0);
        ++count;
      }
    };
    for (std::size_t i = 0; i < x_.size(); ++i)
      check(box_, i, x_[i] - problem_.lower, problem_.upper - x_[i]);
    for (std::size_t i = 0; i < rate_.held.size(); ++i) {
      const double step = x_[i + k_] - x_[i];
      check(rate_, i, step + problem_.max_change, problem_.max_change - step);
    }
    return count;
  }

  [[nodiscard]] double stationarity() const { return largest(gradient_); }
  [[nodiscard]] const std::vector<double>& pair_pull() const { return signed_.rising; }
  // With held values exactly on their limit.
  [[nodiscard]] std::vector<double> x() const {
    std::vector<double> exact = x_;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      if (box_.held[i] != 0) exact[i] = box_.held[i] < 0 ? problem_.lower : problem_.upper;
      exact[i] = std::clamp(exact[i], problem_.lower, problem_.upper);
    }
    return exact;
  }

 private:
  static void choose(Sides& sides, std::size_t i, double above_lower, double below_upper, double lower_pull,
                     double upper_pull) {
    if (lower_pull > above_lower && lower_pull > upper_pull)
      sides.hold(i, -1, above_lower, lower_pull);
    else if (upper_pull > below_upper)
      sides.hold(i, 1, below_upper, upper_pull);
  }

  // Gradient of the Lagrangian, and how far everything is from its equation.
  void measure() {
    for (std::size_t i = 0; i < x_.size(); ++i) signed_.above[i] = box_.held[i] * box_.pull[i];
    for (std::size_t i = 0; i < rate_.held.size(); ++i) signed_.rising[i] = rate_.held[i] * rate_.pull[i];
    lagrangian_gradient(problem_, x_, signed_, gradient_);
    worst_ = std::max({largest(gradient_), largest(box_.miss), largest(rate_.miss)});
  }

  // The held limits as springs of weight kPenalty beside their multipliers, which take over what the springs
  // carry.
  void step() {
    for (std::size_t i = 0; i < x_.size(); ++i)
      move_[i] = -gradient_[i] + box_.held[i] * kPenalty * box_.miss[i];
    for (std::size_t i = 0; i < rate_.held.size(); ++i) {
      const double spring = rate_.held[i] * kPenalty * rate_.miss[i];
      move_[i] -= spring;
      move_[i + k_] += spring;
    }
    chain_.solve(move_, change_);
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] += move_[i];
    follow(box_, move_);
    follow(rate_, change_);
  }
  static void follow(Sides& sides, const std::vector<double>& moves) {
    for (std::size_t i = 0; i < sides.held.size(); ++i) {
      if (sides.held[i] == 0) continue;
      sides.miss[i] -= sides.held[i] * moves[i];
      sides.pull[i] -= kPenalty * sides.miss[i];
    }
  }

  const ScaledQp& problem_;
  FrameChain& chain_;
  std::size_t k_;
  std::vector<double> x_;
  Sides box_, rate_;
  Multipliers signed_;  // with their signs, in `above` and `rising`
  std::vector<double> gradient_, move_, change_, weights_, ties_;
  double worst_ = 0;
};

}  // namespace

bool polish(const ScaledQp& problem, FrameChain& chain, const std::vector<double>& x,
            const Multipliers& multipliers, PolishedPoint& solved) {
  ActiveSet set(problem, chain, x, multipliers);
  for (solved.num_rounds = 1; solved.num_rounds <= kMaxRounds; ++solved.num_rounds) {
    if (!set.solve()) return false;
    if (set.change_sides(solved.violation) > 0) continue;
    solved.x = set.x();
    solved.pair_pull = set.pair_pull();
    solved.stationarity = set.stationarity();
    return true;
  }
  return false;
}

}  // namespace mien
