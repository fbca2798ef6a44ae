#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mien/models/default/default_model.h"
#include "speech_front.h"

namespace mien::default_model {

/// The next frames of speech, as all performances hear them.
struct Heard {
  std::int64_t first = 0;                 ///< frame
  Tensor features;                        ///< [n, W]
  std::vector<float> closed_probability;  ///< [n], that the lips are closed
  std::vector<Tensor> contexts;           ///< [1, 3 W] at every frame that begins a group, in order
};

/// What does not depend on the seed: speech to features, events and context, as the sound arrives. One for
/// any number of performances.
class Hearing {
 public:
  explicit Hearing(const DefaultModel& model);
  void push(std::span<const float> samples);
  /// The sound is over.
  void finish();

  /// Hears some more frames; false when more sound is needed. After finish() there is no end to frames.
  bool hear(Heard& next);
  /// Frames of the whole performance; -1 before finish().
  [[nodiscard]] std::int64_t num_frames() const { return num_frames_; }
  /// Share of speech around frame n: 0 in silence. @pre a frame after n was heard; not forgotten
  [[nodiscard]] float speech_gate(std::int64_t n) const;
  /// Forgets what speech_gate() needs before frame n.
  void forget_before(std::int64_t n);

 private:
  void add_group(const Tensor& features);

  const DefaultModel model_;
  SpeechFront front_;
  Tensor recent_features_;  // the last 3 frames
  Tensor context_;          // [1, 3 W] the last groups' means
  std::int64_t num_heard_ = 0, num_samples_ = 0, num_frames_ = -1;
};

}  // namespace mien::default_model
