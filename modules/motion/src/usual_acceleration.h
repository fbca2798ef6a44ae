#pragma once
#include <cstdint>
#include <vector>

#include "mien/core/motion.h"
#include "mien/motion/kept_values.h"

namespace mien {

/// How fast channels, and parts of a face, change their speed in a motion that is edited: second differences,
/// a frame squared. A part is what moves together: lips with jaw and cheeks; lids with brows; gaze; head. Of
/// vertices, all are one part. The acceleration of a part is the length of its channels'.
class UsualAcceleration {
 public:
  /// @param names  says what the channels are; its values are not read
  UsualAcceleration(const KeptValues& motion, const Motion& names);

  /// The 95th percentile of a channel's own.
  [[nodiscard]] double of_channel(std::int64_t c) const { return channels_[static_cast<std::size_t>(c)]; }

  /// What a channel may have in frame n of a new motion. When all channels of a part keep to it, the part is
  /// within nine tenths of its 95th percentile, or within the old motion's own value in that frame, where it
  /// is larger: a join in what is rough cannot be smoother. What a part may have beyond the old motion is
  /// shared out among its channels as their percentiles are. 0 where nothing accelerates: it goes on in a
  /// line.
  [[nodiscard]] double limit(std::int64_t n, std::int64_t c) const;

 private:
  struct Part {
    std::vector<double> squares;  // [N] of the motion
    double usual_square = 0;      // of the 95th percentile of the lengths
    double share_square = 0;      // the channels' percentiles, squared, together
  };
  [[nodiscard]] double own(std::int64_t n, std::int64_t c) const;

  const KeptValues& motion_;
  std::vector<double> channels_;      // [C]
  std::vector<std::size_t> part_of_;  // [C]
  std::vector<Part> parts_;
};

}  // namespace mien
