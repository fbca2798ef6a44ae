#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mien/core/motion.h"
#include "mien/core/motion_resampler.h"
#include "mien/io/motion_writer.h"
#include "outputs.h"

namespace mien {

/// The outputs of one take while its frames arrive. Files that need no more than one frame at a time are
/// written at once; the motion is kept in memory only when another output needs all of it.
class TakeFiles {
 public:
  /// @param format  of the motion, without frames   @param fps  of what is written; 0: that of the format
  static Result<TakeFiles> create(std::span<const Output> outputs, const Motion& format, double fps,
                                  const std::string& audio_name);
  /// The output is one of the files that add() writes.
  static bool is_streamed(const Output& output);

  /// @param frames  [n, C] at the rate of the format
  Status add(std::span<const float> frames);
  /// No more frames come: motion() is whole.
  Status end();
  /// The files appear. Warnings: "file: what it could not hold".
  Status finish();

  /// At the rate of the outputs; empty when all of them are streamed.
  [[nodiscard]] const Motion& motion() const { return motion_; }
  /// Length of what add() was given.
  [[nodiscard]] double seconds() const;

 private:
  struct File {
    std::string name;
    MotionWriter writer;
  };
  TakeFiles() = default;
  Status write(std::span<const float> frames);

  std::vector<File> files_;
  std::optional<MotionResampler> resampler_;
  std::vector<float> resampled_;
  Motion motion_;
  bool keeps_motion_ = false;
  std::size_t num_values_ = 0;
  double values_a_second_ = 1;
};

}  // namespace mien
