#pragma once
#include <cstdint>

#include "mien/train/training_set.h"

namespace mien::train {

/// What the brow path should do: amplitude of the raise that it should let begin at frame n of an entry, 0
/// for none.
///
/// A raise begins in the frame of the accent that it belongs to; one without an accent (at the end of a
/// question) in the frame after its centre. The true raise begins about 240 ms before its accent, when the
/// accent cannot have been heard, and scatters by 40 ms. The path hears 142 to 192 ms beyond the onset it
/// decides (by its place in the step), so it knows that much of the sound after the accent; what the encoder
/// says of an accent is clear in the frame of the accent and hardly earlier. The top follows some 105 ms
/// after the onset (mien/motion/brow_raise.h), inside the 150 ms in which brows and accents are taken to
/// belong together (docs/metrics.md). The true scatter on top of that delay would carry a part of the raises
/// beyond it, so it is not learnt.
float raise_that_begins(const TrainingSet& set, std::int64_t take, const TrainingSet::Entry& entry,
                        std::int64_t n);

}  // namespace mien::train
