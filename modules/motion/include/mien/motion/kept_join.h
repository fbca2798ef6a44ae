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
/// then fades in 0.08 s: eyes leap. ARKit coefficients stay in 0 ... 1 where the model's and the motion's
/// are.
///
/// The acceleration at a join, second differences centred on the last kept and the first new frame, is then
/// within the motion's own, for each part of the face (lips with jaw and cheeks; lids with brows; gaze; head;
/// all vertices): at most its 95th percentile, or the motion's in that frame where it is larger. Where it is
/// above nine tenths of that, the first two new frames are put at the limit and what follows them is eased,
/// within 0.12 s, or farther where that is not enough. In a part that the motion holds still two frames go on
/// as the kept ones move. Needs two kept frames beside a stretch of at least four.
///
/// Lips that the model closes (jawOpen - mouthClose at most 0) stay closed: by mouthClose where it is not
/// kept, else by jawOpen; what would part them falls back to the model's. Within 50 ms of a join this gives
/// way to the join.
///
/// @param made  [N, C] like the motion that `kept` is made of; becomes the result
void join_kept(const KeptValues& kept, Motion& made);

/// How rough the joins of a stretch are: the sum over channels, and over the frames around both ends and
/// those that were eased, of squared second differences, each in units of the 95th percentile of its
/// channel's in the motion that is edited. To choose by.
double join_roughness(const KeptValues& kept, const Motion& joined, FrameRange stretch);

}  // namespace mien
