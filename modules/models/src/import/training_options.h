#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "mien/io/pickle.h"

namespace mien {

/// The first integer under `key` in the options that a trainer saved beside its weights: dictionaries and
/// OmegaConf's objects, which are looked into as data. The search is bounded, since such objects hold
/// references to their parents.
std::optional<std::int64_t> find_option(const PickleValue& root, std::string_view key);
/// The same for a list of integers.
std::optional<std::vector<std::int64_t>> find_option_list(const PickleValue& root, std::string_view key);

}  // namespace mien
