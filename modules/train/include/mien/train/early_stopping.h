#pragma once
#include <torch/torch.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "mien/train/torch_parameters.h"

namespace mien::train {

/// Ends a training when its validation has not got better for some epochs. Its state belongs to the
/// checkpoint, so that an interrupted run ends where it would have ended.
class EarlyStopping {
 public:
  enum class Monitor {
    /// What ProbTalk3D's program looks at: its sums of losses are never reset, so every loss that it logs is
    /// the mean of all since training began, and an epoch's figure the mean of those of its steps
    /// (specification, section 6.5). It goes on falling for long after the losses rise again.
    running_mean,
    epoch_mean,  ///< the mean loss of the epoch alone
  };
  /// @param patience  epochs without a new least figure; 0: it never ends
  EarlyStopping(Monitor monitor, std::int64_t patience);

  /// The validation losses of an epoch, in their order. Whether their figure is the least so far. Without
  /// losses nothing is known: it is not, and nobody waits.
  bool observe(std::span<const double> losses);
  /// The figure of the last epoch, in float32 as the program sums.
  [[nodiscard]] double figure() const;
  [[nodiscard]] bool is_over() const;
  /// What a checkpoint keeps of it.
  [[nodiscard]] std::vector<Collect::Entry> entries();

 private:
  Monitor monitor_;
  std::int64_t patience_;
  torch::Tensor state_;  // sum, count, least figure, epochs since then, last figure
};
std::optional<EarlyStopping::Monitor> parse_monitor(std::string_view name);  ///< "running_mean" ...

}  // namespace mien::train
