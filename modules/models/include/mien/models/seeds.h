#pragma once
#include <cstdint>

#include "mien/base/hash.h"

namespace mien {

/// The seed of a take: take 0 has the seed itself, the others are derived from it.
inline std::uint64_t performance_seed(std::uint64_t seed, int take) {
  return take == 0 ? seed : hash_combine(seed, static_cast<std::uint64_t>(take));
}

}  // namespace mien
