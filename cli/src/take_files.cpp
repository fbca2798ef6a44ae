#include "take_files.h"

namespace mien {

bool TakeFiles::is_streamed(const Output& output) {
  return output.kind == OutputKind::motion && !output.is_derived && MotionWriter::can_write(output.path);
}

Result<TakeFiles> TakeFiles::create(std::span<const Output> outputs, const Motion& format, double fps,
                                    const std::string& audio_name) {
  TakeFiles take;
  take.motion_ = format;
  take.values_a_second_ = format.fps * static_cast<double>(format.num_channels());
  if (fps > 0 && fps != format.fps) {
    take.motion_.fps = fps;
    take.resampler_.emplace(format.fps, fps, format.num_channels());
  }
  for (const Output& output : outputs) {
    if (!is_streamed(output)) {
      take.keeps_motion_ = true;
      continue;
    }
    MIEN_TRY(MotionWriter writer, MotionWriter::create(output.path, take.motion_, audio_name));
    take.files_.push_back({output.path.string(), std::move(writer)});
  }
  return take;
}

Status TakeFiles::write(std::span<const float> frames) {
  if (keeps_motion_) motion_.values.insert(motion_.values.end(), frames.begin(), frames.end());
  for (File& file : files_) {
    const Status written = file.writer.add(frames);
    if (!written) return written.error();
  }
  return Done{};
}

Status TakeFiles::add(std::span<const float> frames) {
  num_values_ += frames.size();
  if (!resampler_) return write(frames);
  resampled_.clear();
  resampler_->push(frames, resampled_);
  return write(resampled_);
}

Status TakeFiles::end() {
  if (!resampler_) return Done{};
  resampled_.clear();
  resampler_->finish(resampled_);
  return write(resampled_);
}

Status TakeFiles::finish() {
  Status all = Done{};
  for (File& file : files_) {
    const Status finished = file.writer.finish();
    if (!finished) return finished.error();
    for (const auto& warning : finished.warnings) all.warnings.push_back(file.name + ": " + warning);
  }
  return all;
}

double TakeFiles::seconds() const { return static_cast<double>(num_values_) / values_a_second_; }

}  // namespace mien
