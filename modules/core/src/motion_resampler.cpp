#include "mien/core/motion_resampler.h"

#include <algorithm>

#include "mien/base/contract.h"
#include "mien/core/motion.h"

namespace mien {

MotionResampler::MotionResampler(double from_fps, double to_fps, std::int64_t width)
    : from_fps_(from_fps), to_fps_(to_fps), width_(width) {
  contract(from_fps > 0 && to_fps > 0 && width > 0, "MotionResampler: rates and a width above 0 expected");
}

std::int64_t MotionResampler::frames_of_input() const {
  return num_motion_frames(static_cast<double>(num_in_) / from_fps_, to_fps_);
}

void MotionResampler::push(std::span<const float> frames, std::vector<float>& out) {
  contract(!is_over_, "MotionResampler: push after finish");
  contract(frames.size() % static_cast<std::size_t>(width_) == 0, "MotionResampler: whole frames expected");
  held_.insert(held_.end(), frames.begin(), frames.end());
  num_in_ += static_cast<std::int64_t>(frames.size()) / width_;
  write_until(frames_of_input(), out);
  // Frames before the left neighbour of the next one are not needed; the last one stays, for the end.
  const auto left = static_cast<std::int64_t>(static_cast<double>(num_out_) * from_fps_ / to_fps_);
  const std::int64_t from = std::max(first_held_, std::min(left, num_in_ - 1));
  held_.erase(held_.begin(), held_.begin() + (from - first_held_) * width_);
  first_held_ = from;
}

void MotionResampler::finish(std::vector<float>& out) {
  is_over_ = true;
  if (num_in_ > 0) write_until(std::max<std::int64_t>(1, frames_of_input()), out);
}

void MotionResampler::write_until(std::int64_t end, std::vector<float>& out) {
  const auto width = static_cast<std::size_t>(width_);
  for (; num_out_ < end; ++num_out_) {
    const double position =
        std::min(static_cast<double>(num_out_) * from_fps_ / to_fps_, static_cast<double>(num_in_ - 1));
    const auto left = static_cast<std::int64_t>(position);
    if (!is_over_ && left + 1 >= num_in_) return;
    const auto right = std::min(left + 1, num_in_ - 1);
    const double w = position - static_cast<double>(left);
    const float* a = held_.data() + (left - first_held_) * width_;
    const float* b = held_.data() + (right - first_held_) * width_;
    for (std::size_t c = 0; c < width; ++c)
      out.push_back(static_cast<float>(a[c] + w * (static_cast<double>(b[c]) - a[c])));  // no overflow
  }
}

}  // namespace mien
