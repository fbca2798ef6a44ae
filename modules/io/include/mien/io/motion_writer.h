#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "mien/base/result.h"
#include "mien/core/motion.h"

namespace mien {

/// Writes motion while its frames arrive, in memory that does not grow with their number. The file appears
/// when it is finished; destroyed before, it leaves nothing.
class MotionWriter {
 public:
  /// Whether the format needs no more than one frame at a time: .csv (all forms), .json, .npy.
  static bool can_write(const std::filesystem::path& path);
  /// @param format  space, channels, rate and topology of the motion; its frames are not written
  /// @param audio_name  file name of the speech, stored in .json
  /// @pre can_write(path). Errors: Errc::failed for a place that cannot be written or a rate that is none;
  /// Errc::incompatible for a space that the format does not have.
  static Result<MotionWriter> create(const std::filesystem::path& path, const Motion& format,
                                     std::string_view audio_name = "");
  MotionWriter(MotionWriter&&) noexcept;
  MotionWriter& operator=(MotionWriter&&) noexcept;
  ~MotionWriter();

  /// @param frames  [n, C]. Errors (Errc::failed): a number that is not finite, a full disk.
  Status add(std::span<const float> frames);
  /// Warnings: what the format could not hold.
  Status finish();

 private:
  struct State;
  explicit MotionWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mien
