#pragma once
#include "mien/core/motion.h"
#include "mien/motion/kept_values.h"

namespace mien {

/// Makes one motion of what an edit keeps and what a model made for all frames. Kept entries become their
/// kept value, bit for bit. From each join on, the channel is led from the kept value and velocity to what
/// the model made: its difference d and the difference of velocity v fade as the quintic d H0(t) + v T H1(t),
/// with t = 0 at the last kept frame, t = 1 after T, and no acceleration of its own at either end. T is long
/// enough for the fade to accelerate the channel by half the 95th percentile of its accelerations in the
/// motion, but at most the stretch, and from 0.25 s (lips) to 2 s (head). Of gaze, d is held for 0.1 s and
/// then fades in 0.08 s: eyes leap. What is still rougher than usual beside a join is then eased, within 0.12
/// s of it. ARKit coefficients stay in 0 ... 1 where the model's are.
///
/// Lips that the model closes (jawOpen - mouthClose at most 0) stay closed: by mouthClose where it is not
/// kept, else by jawOpen; what would part them falls back to the model's. Within 50 ms of a join this gives
/// way to the join.
///
/// @param made  [N, C] like the motion that `kept` is made of; becomes the result
void join_kept(const KeptValues& kept, Motion& made);

/// How rough the joins of a stretch are: the sum over channels, and over the frames around both ends, of
/// squared second differences, each in units of the 95th percentile of its channel's in the motion that is
/// edited. To choose by.
double join_roughness(const KeptValues& kept, const Motion& joined, FrameRange stretch);

}  // namespace mien
