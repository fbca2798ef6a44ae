#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "mien/base/bytes.h"
#include "mien/base/random.h"

namespace mien::fuzz {

/// Damages `input` once, in one of the ways that break readers: bits, sizes at their limits, pieces lost,
/// repeated, moved or taken from `other`, numbers in text, and words of the format.
void mutate(Bytes& input, const Bytes& other, std::span<const std::string_view> words, Rng& rng);

}  // namespace mien::fuzz
