#pragma once
#include <cstdint>
#include <functional>

#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien {

/// Runs work(i) for i = 0 ... count-1, each in a fresh copy of this process, at most `jobs` at once, and
/// hands the bytes (or the error) to take(i, ...) here, in order of i. Synthesisers keep global state: a
/// fresh copy per item makes the result independent of the number of jobs and of what was spoken before. A
/// crash of the copy is an error of the item. An error of take() stops the run and is returned, after the
/// copies that still run were waited for.
/// @pre this process has one thread
Status run_forked(int jobs, std::int64_t count, const std::function<Result<Bytes>(std::int64_t)>& work,
                  const std::function<Status(std::int64_t, Result<Bytes>)>& take);

}  // namespace mien
