#pragma once
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "mien/core/motion.h"
#include "mien/corpus/emotion.h"
#include "mien/corpus/gestures.h"
#include "mien/corpus/performance.h"
#include "mien/corpus/speaker.h"
#include "mien/motion/blink.h"

namespace mien {

/// One performance of an utterance: one draw of everything random (specification, section 8). The motions
/// are at 60 fps and have the 55 channels of arkit_and_head_channels().
struct Take {
  Motion motion;          ///< the whole performance: apply_blinks(without_blinks, blinks), bit for bit
  Motion without_blinks;  ///< the same with the lids where gaze and emotion leave them
  Motion without_events;  ///< without_blinks, and without raises of the brows
  std::vector<BlinkEvent> blinks;   ///< in time order
  std::vector<BrowGesture> raises;  ///< at accents, and at the end of a question
  /// z0 strength of the jaw, z1 of lips and rounding, z2 of the expression: N(0, 1). What a model of takes
  /// can be told.
  std::array<float, 3> latents{};
};

/// Draws a take of num_motion_frames(utterance.seconds, 60) frames. The articulation, gaze, brows, head,
/// blinks and expression have generators of their own, derived from the seed: a change of one process leaves
/// the others as they are (blinks follow gaze shifts, the head follows the gaze).
/// @param intensity  0 ... 1, see intensity_of_level; without effect on neutral
Take draw_take(const Utterance& utterance, const Speaker& speaker, Emotion emotion, double intensity,
               std::uint64_t seed);

/// The performance without chance: no take noise, no blinks, gaze at the viewer, still head.
Motion plain_performance(const Utterance& utterance, const Speaker& speaker, Emotion emotion,
                         double intensity);

/// plain_performance in the default style, neutral: the truth that lip measures compare with.
Motion default_performance(const Utterance& utterance);

/// Mean of `count` takes, with blinks: the approximate conditional mean that scores compare with. Take i has
/// the seed hash_combine(seed, i). The sum is in double precision and in order. @pre count > 0
Motion mean_performance(const Utterance& utterance, const Speaker& speaker, Emotion emotion, double intensity,
                        std::uint64_t seed, int count);

/// Seed of take k of an item.
std::uint64_t take_seed(std::uint64_t corpus_seed, std::string_view item_id, std::uint64_t take_index);

/// Hash of the generator's version and of the tables that decide the curves (visemes, speakers, emotions);
/// stored with a corpus, because curves drawn again from phones equal stored ones only under the same hash.
std::uint64_t generator_hash();

}  // namespace mien
