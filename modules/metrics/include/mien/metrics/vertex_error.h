#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/metrics/vertex_regions.h"

// Errors of vertex sequences, as FaceDiffuser's evaluation program computes them (specification, section 13).
// g and p are truth and prediction, t the subject's neutral mesh; a pair of sequences is cut to its common
// length. Units are those of the data. All sums in double.
namespace mien {

/// Of one pair of sequences. NaN where nothing is defined (no frames, no region, no neutral).
struct VertexError {
  std::string name;
  std::int64_t num_frames = 0;
  double mve = 0;  ///< mean over frames and vertices of |g - p|
  double lve = 0;  ///< mean over frames of the largest squared |g - p|^2 of the mouth
  double fdd =
      0;  ///< mean over upper vertices of std |g - t|^2 less that of std |p - t|^2 (population, over frames)
};

/// Pools sequences.
class VertexErrors {
 public:
  explicit VertexErrors(VertexRegions regions) : regions_(std::move(regions)) {}

  /// @param neutral  [3 V] or empty: then the sequence has no FDD
  /// Errors (Errc::incompatible): the two are not motions of vertices of one topology, the neutral has
  /// another size, or a region leaves the mesh; rates are not compared, because .npy files have none.
  Status add(std::string name, const Motion& truth, const Motion& predicted, std::span<const float> neutral);

  [[nodiscard]] const std::vector<VertexError>& sequences() const { return sequences_; }
  [[nodiscard]] std::int64_t num_frames() const { return num_frames_; }
  /// MVE: mean of |g - p| over all vertices of all frames of all sequences together.
  [[nodiscard]] double mve() const;
  /// LVE: mean over all frames of all sequences of max over mouth vertices of |g - p|^2.
  [[nodiscard]] double lve() const;
  /// FDD: mean over sequences, signed.
  [[nodiscard]] double fdd() const;
  /// ABS FDD: mean over sequences of the absolute values.
  [[nodiscard]] double absolute_fdd() const;

 private:
  VertexRegions regions_;
  std::vector<VertexError> sequences_;
  std::int64_t num_frames_ = 0;
  double distance_sum_ = 0, mouth_sum_ = 0;  // over vertices and frames; over frames
  double num_distances_ = 0;
};

/// Diversity of one sequence: over all unordered pairs of takes, the mean over frames and vertices of their
/// distance, averaged over the pairs. Takes are cut to their common length. NaN with fewer than two takes or
/// without frames.
/// @pre all takes move vertices of one topology
double take_diversity(std::span<const Motion> takes);

}  // namespace mien
