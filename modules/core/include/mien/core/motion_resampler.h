#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace mien {

/// Frames at one rate to frames at another, as they arrive: linear interpolation in time, the last value
/// holds. The cut of the input changes no bit. Holds two frames, and what came in one piece.
class MotionResampler {
 public:
  /// @param width  C   @pre rates above 0, width above 0
  MotionResampler(double from_fps, double to_fps, std::int64_t width);
  /// Appends to `out` the frames that are certain now. @param frames  [n, C]   @pre finish() was not called
  void push(std::span<const float> frames, std::vector<float>& out);
  /// The motion is over: N frames become max(1, num_motion_frames(N / from_fps, to_fps)), none stay none.
  void finish(std::vector<float>& out);

 private:
  // Frames before `end` that do not look beyond what is held.
  void write_until(std::int64_t end, std::vector<float>& out);
  [[nodiscard]] std::int64_t frames_of_input() const;

  double from_fps_, to_fps_;
  std::int64_t width_;
  std::vector<float> held_;      // input frames from first_held_ on
  std::int64_t first_held_ = 0;  // all before are not needed again
  std::int64_t num_in_ = 0, num_out_ = 0;
  bool is_over_ = false;
};

}  // namespace mien
