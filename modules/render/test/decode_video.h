#pragma once
#include <filesystem>
#include <vector>

namespace mien::render_test {

struct DecodedVideo {
  struct Frame {
    double start, seconds;  // when it is shown and for how long
    std::vector<int> luma;  // [height, width]
  };
  int width = 0, height = 0;
  std::vector<Frame> frames;
  int sound_rate_hz = 0;
  double sound_start = 0;                // time of the first sample
  std::vector<float> sound;              // mono
  double seconds = 0;                    // of the whole file, as its header says
  std::vector<double> packet_times;      // decoding order time of each packet in the file, all tracks
  std::vector<double> packet_durations;  // as the file says
  std::vector<bool> packet_is_video;
};

/// Reads the file with libav; an empty result when it cannot be read.
DecodedVideo decode_video(const std::filesystem::path& path);

}  // namespace mien::render_test
