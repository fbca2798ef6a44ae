#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/motion.h"

// Errors of several takes of one sequence, as ProbTalk3D's evaluation program computes them (specification,
// section 13; its paper divides by sequences, the program by frames). g is the truth, p a take; all are cut
// to their common length. E of a frame is the largest squared distance |g - p|^2 of a mouth vertex. Units are
// those of the data. All sums in double.
namespace mien {

/// Of one sequence. NaN where nothing is defined (no frames, no region, fewer than two takes).
struct TakeError {
  std::string name;
  std::int64_t num_frames = 0;
  double mee = 0;        ///< mean over frames of E between the truth and the mean of the takes
  double ce = 0;         ///< mean over frames of E of the take with the smallest sum of E
  double diversity = 0;  ///< mean over pairs, frames and vertices of the distance between two takes
};

/// Pools sequences.
class TakeErrors {
 public:
  /// @param mouth  vertices of the lip region
  explicit TakeErrors(std::vector<std::uint32_t> mouth) : mouth_(std::move(mouth)) {}

  /// @param order  of the takes for the diversity: take order[i] is paired with take order[half + i], each
  /// number once.
  ///               The program shuffles them with NumPy's generator and wants ten; here any even number will
  ///               do, and of an odd number the last of the order has no partner
  /// Errors (Errc::incompatible): not motions of vertices of one topology, or a region that leaves the mesh.
  /// @pre at least one take, as many numbers in the order
  Status add(std::string name, const Motion& truth, std::span<const Motion> takes,
             std::span<const std::size_t> order);

  [[nodiscard]] const std::vector<TakeError>& sequences() const { return sequences_; }
  /// MEE, mean estimate error: mean over all frames of all sequences.
  [[nodiscard]] double mee() const;
  /// CE, coverage error: the same.
  [[nodiscard]] double ce() const;
  /// Diversity: mean over sequences.
  [[nodiscard]] double diversity() const;

 private:
  std::vector<std::uint32_t> mouth_;
  std::vector<TakeError> sequences_;
};

}  // namespace mien
