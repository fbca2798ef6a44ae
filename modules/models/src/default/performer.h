#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>

#include "blink_events.h"
#include "brow_events.h"
#include "hearing.h"
#include "kept_face.h"
#include "mien/models/default/face_space.h"
#include "mien/models/default/stream.h"
#include "upper_face.h"

namespace mien::default_model {

/// One performance of what a Hearing heard.
class Performer {
 public:
  Performer(const DefaultModel& model, const PerformOptions& options);
  /// @pre heard.first is the frame after those that were heard before
  void hear(const Heard& heard);
  /// Whether frame next() can be composed of what was heard.
  [[nodiscard]] bool is_ready() const { return num_heard_ > next_ + kSmootherReach; }
  [[nodiscard]] std::int64_t next() const { return next_; }
  /// The next frame. @pre is_ready(); `hearing` is the one that was heard
  void compose(const Hearing& hearing, std::span<float> channels);

 private:
  // What the mean path says of a frame.
  struct MeanFrame {
    std::array<float, kNumFace> face;  // standardised
    float closed_probability;
  };
  void decide(std::int64_t n, const Tensor& context);
  [[nodiscard]] const MeanFrame& mean_at(std::int64_t n) const;

  const DefaultModel model_;
  PerformOptions options_;
  UpperFace upper_;
  BlinkEvents blinks_;
  BrowEvents brows_;
  std::unique_ptr<const KeptFace> kept_;  // null: nothing
  std::array<float, kNumLatents> latents_{};
  CausalState<Tensor> mean_state_;
  std::deque<MeanFrame> means_;  // from frame means_start_ on
  std::int64_t means_start_ = 0;
  std::int64_t num_heard_ = 0;
  std::int64_t next_ = 0;  // frame to come out
};

}  // namespace mien::default_model
