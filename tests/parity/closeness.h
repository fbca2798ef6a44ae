#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/tensor/tensor.h"

namespace mien::parity {

/// How far a stage may be from what was recorded: |got - want| <= absolute + relative |want|.
struct Tolerance {
  std::string_view stage;
  double absolute;
  double relative;
  std::string_view reason;
};

/// The one table. Stages are listed in tolerances.cpp; an unknown one throws.
const Tolerance& tolerance(std::string_view stage);

/// Empty when all values are close; else a message with the number of values beyond the tolerance and the
/// worst of them: its index by axis, both values. A NaN on either side is a mismatch; sizes must be equal.
std::string differences(std::span<const double> got, std::span<const double> want, const Tolerance& tolerance,
                        const Shape& shape = {});
std::string differences(const Tensor& got, const Tensor& want, const Tolerance& tolerance);

/// The largest |got - want|; infinite with NaN or unequal sizes. For what a test prints.
double largest_difference(const Tensor& got, const Tensor& want);

}  // namespace mien::parity

/// Fails when `got` (a Tensor, or doubles) is not as close to `want` as the table says for the stage.
#define MIEN_EXPECT_CLOSE(got, want, stage) \
  EXPECT_EQ(mien::parity::differences(got, want, mien::parity::tolerance(stage)), "")
