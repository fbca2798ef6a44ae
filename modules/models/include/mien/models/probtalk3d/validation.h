#pragma once
#include <cstdint>
#include <span>

#include "mien/tensor/tensor.h"

// What ProbTalk3D's programs print beside the losses of a validation (specification, sections 6.2 and 6.5).
namespace mien::probtalk3d {

/// How many codes are in use: exp of the entropy of their relative frequencies; from 1 to num_codes.
/// NaN without codes. @pre 0 <= code < num_codes
double code_perplexity(std::span<const std::int64_t> codes, std::int64_t num_codes);

/// How far a motion is from the truth, both [N, C] in the normalised range.
struct MotionDistance {
  double mean_l2 = 0;   ///< mean over frames of the Euclidean norm of the error
  double mean_var = 0;  ///< Euclidean norm of the difference of the columns' variances, divisor N - 1
};
/// @pre equal shapes. NaN: both without frames, the second with one
MotionDistance motion_distance(const Tensor& predicted, const Tensor& truth);

}  // namespace mien::probtalk3d
