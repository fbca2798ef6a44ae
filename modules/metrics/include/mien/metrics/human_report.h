#pragma once
#include <cstdint>

#include "mien/metrics/human_benchmark.h"
#include "mien/metrics/report.h"

namespace mien {

/// The report of an evaluation on people: a column per group that has recordings (English clean first: the
/// main number), and the loudness-only baseline on the English clean recordings as the last. With intervals
/// over speakers unless num_draws is 0, in the main column and the baseline's. Notes state the aperture
/// variant, frame rate and takes, name groups with fewer than 30 targets, and give the paired difference of
/// closure F1 to the baseline.
MetricTable human_table(const HumanReport& report, int num_draws = kDefaultDraws, std::uint64_t seed = 1);

}  // namespace mien
