#pragma once
#include <cstdint>

#include "mien/corpus/performance.h"

namespace mien {

/// A plausible phone sequence of about `seconds` without any synthesiser: words of a small ARPABET lexicon
/// and nonsense words, English-like phone durations, pauses between phrases, closure windows as flite gives
/// them, about one accent a second, and 0.15-0.5 s of silence at both ends.
Utterance synthetic_utterance(double seconds, std::uint64_t seed);

}  // namespace mien
