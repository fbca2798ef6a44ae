#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/motion.h"

// Errors of blendshape coefficients and rig controls, as FaceDiffuser's evaluation program computes them
// (specification, section 13). A pair of sequences is cut to its common length. All sums in double.
namespace mien {

/// Channels that a measure looks at.
struct ControlRegions {
  std::vector<std::size_t> mouth, upper;
};

/// The authors' regions by the number of channels: 51 (BEAT) and 192 (UUDaMM); nothing for others.
std::optional<ControlRegions> control_regions(std::int64_t num_channels);

/// Of one pair of sequences; NaN where nothing is defined.
struct ControlError {
  std::string name;
  std::int64_t num_frames = 0;
  double mce = 0;  ///< mean over frames of |p - g|, the length of the difference over all channels
  double lce = 0;  ///< the same over the mouth's channels
  double fdd =
      0;  ///< std over frames of the sum of squares of the upper face, truth less prediction (population)
};

/// Collects sequences; every figure is the plain mean over them.
class ControlErrors {
 public:
  explicit ControlErrors(ControlRegions regions) : regions_(std::move(regions)) {}

  /// Errors (Errc::incompatible): different numbers of channels, or a region beyond them.
  Status add(std::string name, const Motion& truth, const Motion& predicted);

  [[nodiscard]] const std::vector<ControlError>& sequences() const { return sequences_; }
  [[nodiscard]] std::int64_t num_frames() const;
  [[nodiscard]] double mce() const;
  [[nodiscard]] double lce() const;
  [[nodiscard]] double fdd() const;
  [[nodiscard]] double absolute_fdd() const;

 private:
  ControlRegions regions_;
  std::vector<ControlError> sequences_;
};

}  // namespace mien
