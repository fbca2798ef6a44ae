#pragma once
#include "mien/datasets/prepare.h"

namespace mien::datasets {

/// See prepare_dataset(). @pre kind is biwi or biwi_expressive
Result<PrepareReport> prepare_biwi(DatasetKind kind, const std::filesystem::path& raw,
                                   const std::filesystem::path& out, const PrepareOptions& options,
                                   Progress& progress);
Result<PrepareReport> prepare_vocaset(const std::filesystem::path& raw, const std::filesystem::path& out,
                                      const PrepareOptions& options, Progress& progress);
Result<PrepareReport> prepare_multiface(const std::filesystem::path& raw, const std::filesystem::path& out,
                                        const PrepareOptions& options, Progress& progress);
Result<PrepareReport> prepare_uudamm(const std::filesystem::path& raw, const std::filesystem::path& out,
                                     const PrepareOptions& options, Progress& progress);
Result<PrepareReport> prepare_beat(const std::filesystem::path& raw, const std::filesystem::path& out,
                                   Progress& progress);

}  // namespace mien::datasets
