#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/motion.h"

namespace mien::io {

/// What every writer of motion needs: a positive rate, whole frames, finite numbers.
/// Errors (Errc::failed), naming the frame and the channel. @pre whole frames
Status check_motion(const Motion& motion, std::string_view writer);
/// The same of frames of such a motion, the first of which is frame `first`. @param values  [n, C]
Status check_frames(const Motion& format, std::int64_t first, std::span<const float> values,
                    std::string_view writer);

/// What a file may state as the rate of its motion, frames a second: seconds between frames, or a slip of the
/// writer, would make hours of a few rows.
constexpr bool is_frame_rate(double fps) { return fps >= 0.1 && fps <= 10000; }

/// Keys closer than this to the instant of a frame are taken as they are.
inline constexpr double kSnapFrames = 0.05;

/// Motion from instants that need not be even: frame n is the value at n / fps, between rows linearly; rows
/// closer than 1/20 frame to it are taken as they are. `times` rise strictly and start at 0. [R] seconds and
/// [R, C] values. Errors (Errc::input): more frames than eight per row and an hour.
Result<Motion> even_motion(const std::vector<double>& times, const std::vector<float>& rows,
                           std::vector<std::string> channels, double fps);

/// Where an instant lies between keys.
struct KeyPosition {
  std::size_t key = 0;
  double weight = 0;  ///< of key + 1; 0 at the last key
};
/// `times` rise strictly, at least one; instants within `snap` seconds of a key are at that key.
KeyPosition find_key(const std::vector<double>& times, double time, double snap);

/// Frames needed to hold the last of `num_keys` keys. Errors as even_motion().
Result<std::int64_t> num_even_frames(double last_time, double fps, std::size_t num_keys);

}  // namespace mien::io
