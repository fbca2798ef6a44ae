#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "mien/audio/log_mel.h"
#include "mien/audio/running_level.h"
#include "mien/models/default/default_model.h"

namespace mien::default_model {

/// Samples -> speech features at 60 fps, as the sound arrives.
class SpeechFront {
 public:
  explicit SpeechFront(const DefaultModel& model);
  void push(std::span<const float> samples);
  /// The sound is over; frames beyond its end hear silence.
  void finish();

  /// Features [n, W] of the frames that became available, at most `limit`; n may be 0. After finish() there
  /// is no end to the frames.
  Tensor take(std::int64_t limit);
  /// Loudness relative to the running level, ln power, of mel frame t; far below speech after the end.
  /// @pre not yet dropped, and heard already (or the sound is over)
  [[nodiscard]] float loudness(std::int64_t t) const;
  /// Forgets loudness before mel frame t.
  void drop_loudness_before(std::int64_t t);

 private:
  void collect_mel();
  void encode(std::int64_t num_silent);
  [[nodiscard]] std::int64_t num_frames_heard() const;

  const DefaultModel model_;
  LogMelStream log_mel_;
  RunningLevel level_;
  bool finished_ = false;
  std::vector<float> pending_;  // normalised mel frames not yet encoded
  std::deque<float> loudness_;
  std::int64_t loudness_start_ = 0;
  CausalState<Tensor> mel_state_, frame_state_;
  Tensor encoded_;  // 100 Hz rows from row encoded_start_ on
  std::int64_t encoded_start_ = 0;
  std::int64_t next_frame_ = 0;  // 60 fps
};

}  // namespace mien::default_model
