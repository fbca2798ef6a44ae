#pragma once
#include <span>
#include <string>
#include <string_view>

namespace mien {

/// The candidate that is most likely meant by a mistyped word: fewest insertions, deletions, replacements and
/// swaps of neighbours. Empty when all are too far away (more than a third of the word, at least 2).
std::string nearest_name(std::string_view word, std::span<const std::string> candidates);

}  // namespace mien
