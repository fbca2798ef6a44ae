#pragma once
#include <cstdint>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include "mien/base/hash.h"
#include "mien/base/random.h"

namespace mien::train {

/// What a step, or a validation, draws from.
inline std::uint64_t seed_of(std::string_view purpose, std::uint64_t seed, std::int64_t index) {
  return hash_combine(hash64(purpose, seed), static_cast<std::uint64_t>(index));
}

/// Every sequence once an epoch, in a new order for each, which follows from the seed.
class EpochOrder {
 public:
  EpochOrder(std::size_t num_sequences, std::uint64_t seed) : order_(num_sequences), seed_(seed) {}

  /// The sequence that a step learns from. @pre there is one
  std::size_t at(std::int64_t step) {
    const auto count = static_cast<std::int64_t>(order_.size());
    if (step / count != epoch_) shuffle(step / count);
    return order_[static_cast<std::size_t>(step % count)];
  }

 private:
  void shuffle(std::int64_t epoch) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    Rng random(seed_of("order", seed_, epoch));
    for (std::size_t i = order_.size(); i > 1; --i) std::swap(order_[i - 1], order_[random.below(i)]);
    epoch_ = epoch;
  }
  std::vector<std::size_t> order_;
  std::uint64_t seed_;
  std::int64_t epoch_ = -1;
};

}  // namespace mien::train
