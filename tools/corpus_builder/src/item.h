#pragma once
#include <cstdint>

#include "augment.h"
#include "clip.h"
#include "plan.h"

namespace mien {

/// Speaks the sentences of a plan and joins them until its target is full (12 to about 20 s for training
/// items), with pauses of 0.05-0.6 s between and 0.15-0.5 s around; or makes the sound of a non-speech item.
Result<Clip> speak_item(const ItemPlan& item, std::uint64_t seed);

/// Noise, near silence or tones at the level of speech, in which nobody speaks (spec section 16).
Clip make_non_speech(NonSpeech kind, double seconds, Rng& rng);

/// Clips that babble noise is mixed from: sentences of the plan's training items by several voices, at equal
/// loudness. Spoken in processes of their own, see run_forked(): this process stays as it was.
BabblePool make_babble_pool(const std::vector<ItemPlan>& items, std::size_t count, std::uint64_t seed,
                            int jobs);

}  // namespace mien
