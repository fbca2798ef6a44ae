#pragma once
#include <filesystem>

#include "augment.h"
#include "item.h"
#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "plan.h"
#include "prepared_entry.h"

namespace mien {

struct PrepareSetOptions {
  TrainingPlanOptions plan;
  int copies = 2;  ///< differently augmented copies of every item
  int takes = 3;   ///< per copy, each in a training style of its own
  int jobs = 1;    ///< processes at once; without effect on the result
};

struct PrepareSummary {
  std::int64_t items = 0, entries = 0, skipped = 0;
  double distinct_hours = 0, hours = 0;  ///< before and after copying
};

/// All entries of one item: spoken once, then worsened, measured and performed for every copy.
Result<std::vector<PreparedEntry>> prepare_item(const ItemPlan& item, const PrepareSetOptions& options,
                                                const BabblePool& pool);

/// Entry of one recording. @param name  decides the takes, together with the seed
PreparedEntry make_entry(std::span<const float> samples_16k, const Utterance& spoken, const ItemPlan& item,
                         int takes, std::uint64_t seed, std::string_view name);

/// Plans, speaks and writes a prepared training set. The file depends on the options (without jobs) and the
/// versions of the engines only. Items that fail are skipped with a warning. Errors: no engine, the disk,
/// cancelled.
Result<PrepareSummary> prepare_set(const std::filesystem::path& path, const PrepareSetOptions& options,
                                   Progress& progress);

}  // namespace mien
