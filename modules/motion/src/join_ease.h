#pragma once
#include <span>

namespace mien {

/// Eases a channel where it leaves what is kept. `values` are two kept ones, then those that may move, then
/// two that stay. They move by least squares, min |change|^2 + lambda sum of weighted squared second
/// differences, with the smallest lambda of a rising series for which the differences centred on the last
/// kept and the first free value are at most `at_kept` and `at_free` and all others at most `elsewhere` or
/// what they were; where none is, the one that comes nearest. Nothing moves when it is smooth enough, or when
/// less than two may move.
void ease_join(std::span<double> values, double at_kept, double at_free, double elsewhere);

}  // namespace mien
