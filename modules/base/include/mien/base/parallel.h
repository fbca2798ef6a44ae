#pragma once
#include <cstdint>
#include <functional>

namespace mien {

/// Calls body(i) for i in 0 ... count-1 on up to `num_threads` threads (the caller is one of them). Items are handed
/// out in order; each item must write only its own outputs, so the result does not depend on the number of threads.
/// An exception of a body stops the hand-out and is rethrown here.
void parallel_for(int num_threads, std::int64_t count, const std::function<void(std::int64_t)>& body);

/// Number of processors this process may use, at least 1.
int hardware_threads();

}  // namespace mien
