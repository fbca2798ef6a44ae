#pragma once
#include <filesystem>
#include <functional>

#include "mien/metrics/synthetic_benchmark.h"

namespace mien {

/// Keeps what a benchmark compared, under names that the other evaluations pair: truth/sentenceNN.csv,
/// takes/sentenceNN-1.csv ... (Live Link Face) and wav/sentenceNN.wav, items numbered from 1. Makes the
/// folders. Errors: Errc::failed for what cannot be made or written; Errc::usage for a folder that holds such
/// files already.
Result<std::function<Status(const SyntheticPerformances&)>> benchmark_files(
    const std::filesystem::path& folder);

}  // namespace mien
