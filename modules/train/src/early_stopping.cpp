#include "mien/train/early_stopping.h"

#include <limits>

namespace mien::train {
namespace {

enum State { kSum, kCount, kLeast, kWaited, kFigure, kNumStates };

}  // namespace

std::optional<EarlyStopping::Monitor> parse_monitor(std::string_view name) {
  if (name == "running_mean") return EarlyStopping::Monitor::running_mean;
  if (name == "epoch_mean") return EarlyStopping::Monitor::epoch_mean;
  return std::nullopt;
}

EarlyStopping::EarlyStopping(Monitor monitor, std::int64_t patience)
    : monitor_(monitor), patience_(patience), state_(torch::zeros({kNumStates})) {
  state_[kLeast] = std::numeric_limits<float>::infinity();
}

bool EarlyStopping::observe(std::span<const double> losses) {
  if (losses.empty()) return false;
  float* state = state_.data_ptr<float>();
  if (monitor_ == Monitor::epoch_mean) state[kSum] = state[kCount] = 0;
  double sum_of_means = 0;
  for (const double loss : losses) {
    state[kSum] += static_cast<float>(loss);
    state[kCount] += 1;
    sum_of_means += static_cast<double>(state[kSum]) / static_cast<double>(state[kCount]);
  }
  state[kFigure] = monitor_ == Monitor::epoch_mean
                       ? state[kSum] / state[kCount]
                       : static_cast<float>(sum_of_means / static_cast<double>(losses.size()));
  const bool is_least = state[kFigure] < state[kLeast];
  state[kWaited] = is_least ? 0 : state[kWaited] + 1;
  if (is_least) state[kLeast] = state[kFigure];
  return is_least;
}

double EarlyStopping::figure() const { return static_cast<double>(state_.data_ptr<float>()[kFigure]); }

bool EarlyStopping::is_over() const {
  return patience_ > 0 && state_.data_ptr<float>()[kWaited] >= static_cast<float>(patience_);
}

std::vector<Collect::Entry> EarlyStopping::entries() { return {{"early_stopping", &state_, false}}; }

}  // namespace mien::train
