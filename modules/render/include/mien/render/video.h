#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "mien/base/result.h"
#include "mien/render/image.h"

namespace mien {

struct VideoOptions {
  int width = 512;            ///< pixels, even, 16 to 8192
  int height = 512;           ///< pixels, even, 16 to 8192
  double fps = 30;            ///< frames a second, 1 to 240
  int sound_rate_hz = 0;      ///< sample rate of the mono sound; 0: a silent film without a sound track
  std::string video_encoder;  ///< libav's name; empty: libx264 for .mp4, libvpx-vp9 for .webm
  std::string sound_encoder;  ///< libav's name; empty: aac for .mp4, libopus for .webm
};

/// Writes a video with sound by libav. Frame n is shown from n / fps to (n + 1) / fps; sound sample i is
/// heard at i / sound_rate_hz: both tracks start at zero and keep every frame and sample. The same input
/// gives the same bytes (one thread for each encoder, no dates or random names in the file). The file appears
/// under its name by finish().
///
/// x264 is under the GPL and is reached only through libav, where libav was built with it; .webm needs
/// neither.
class VideoWriter {
 public:
  /// Errors: Errc::usage for options outside of their range and an extension other than .mp4 and .webm;
  /// Errc::failed when this libav lacks the encoder, the encoder refuses the sound's rate, or the file cannot
  /// be written.
  static Result<VideoWriter> create(const std::filesystem::path& path, const VideoOptions& options);
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;
  /// Without finish() nothing is left behind.
  ~VideoWriter();

  /// @pre the image has the size of the options
  Status add_frame(const Image& image);
  /// The next samples, full scale [-1, 1]; values that are not finite count as zero. May run ahead of the
  /// pictures or behind; it is kept until its time has come. @pre sound_rate_hz > 0
  Status add_sound(std::span<const float> samples);
  /// Writes what is left and gives the file its name. Errors also when there was no frame. @pre called once
  Status finish();

 private:
  struct State;
  explicit VideoWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// True for the extensions that VideoWriter knows.
[[nodiscard]] bool is_video_path(const std::filesystem::path& path);

}  // namespace mien
