#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/motion/schedule.h"

namespace mien {

/// Noise schedules of discrete processes by name.
enum class BetaSchedule {
  cosine,  ///< beta_i = min(1 - f((i+1)/T) / f(i/T), 0.999), f = alpha_bar of cosine_level()
  linear,  ///< T even values from 1e-4 to 0.02, both times 1000 / T
};
std::optional<BetaSchedule> parse_beta_schedule(std::string_view name);  ///< "cosine", "linear"
std::string_view beta_schedule_name(BetaSchedule schedule);

/// @return [T] betas.  @pre num_steps >= 1
std::vector<double> betas_of(BetaSchedule schedule, std::int64_t num_steps);

/// Which of T steps a shorter process keeps, rising (the rules of FaceDiffuser's diffusion library):
/// "ddimM" takes every s-th step from 0, with the smallest s that gives M steps; "a,b,c" cuts [0, T) into as
/// many equal sections as there are counts (the first T mod n are one longer) and spreads that many steps in
/// each, ends included, rounded half to even. Empty text keeps all.
/// Errors (Errc::usage): not of this form, no such stride, more steps wanted than a section has.
Result<std::vector<std::int64_t>> respaced_steps(std::string_view rule, std::int64_t num_steps);

/// A discrete diffusion process with fixed small variance, in double (Ho et al. 2020; Nichol and Dhariwal
/// 2021). Index i = 0 is the least noisy; the level before it is clean.
class DiffusionProcess {
 public:
  /// The process of T steps itself.  @pre at least one beta, all in (0, 1)
  explicit DiffusionProcess(std::vector<double> betas);
  /// The same as the diffusers library has it: betas and 1 - beta are float32, and every product of them is
  /// rounded to float32 after it was accumulated in double.
  static DiffusionProcess in_float32(std::span<const double> betas);
  /// The process on a subset of the steps of this one, so that its levels are theirs.
  /// @pre kept rises, is not empty and lies in 0 ... size() - 1
  [[nodiscard]] DiffusionProcess respaced(std::span<const std::int64_t> kept) const;

  [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(betas_.size()); }
  [[nodiscard]] const std::vector<double>& betas() const { return betas_; }
  /// Product of 1 - beta up to index i; 1 for i = -1.
  [[nodiscard]] double alpha_bar(std::int64_t i) const;
  /// x_t = alpha x0 + sigma epsilon at index i; clean for i = -1.
  [[nodiscard]] NoiseLevel level(std::int64_t i) const;
  /// The step number that the network was trained with at index i.
  [[nodiscard]] std::int64_t network_step(std::int64_t i) const {
    return network_steps_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] std::int64_t num_network_steps() const { return num_network_steps_; }

  /// Mean of x at i - 1 given x0 and x at i: x0_weight(i) x0 + x_weight(i) x_t.
  [[nodiscard]] double posterior_x0_weight(std::int64_t i) const;
  [[nodiscard]] double posterior_x_weight(std::int64_t i) const;
  [[nodiscard]] double posterior_variance(std::int64_t i) const;  ///< 0 at index 0
  /// Its logarithm, with index 1 standing in for index 0, whose variance is 0.
  [[nodiscard]] double posterior_log_variance(std::int64_t i) const;

  /// The levels a sampler walks when it leaves out the `skip` noisiest steps: those of indices
  /// size() - 1 - skip ... 0, then clean.  @pre 0 <= skip < size()
  [[nodiscard]] std::vector<NoiseLevel> sampling_levels(std::int64_t skip = 0) const;

 private:
  std::vector<double> betas_, alpha_bars_;
  std::vector<std::int64_t> network_steps_;
  std::int64_t num_network_steps_ = 0;
};

}  // namespace mien
