#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "mien/models/default/default_model.h"
#include "mien/models/direction.h"
#include "mien/motion/kept_values.h"
#include "mien/motion/sampler.h"

namespace mien {

/// What a performance may be asked for.
struct PerformOptions {
  Direction direction;
  std::uint64_t seed = 0;  ///< same seed, same performance: bit for bit, however the sound arrives
  SamplerOptions sampler;  ///< of the diffused upper face
  int num_steps = 8;       ///< diffusion steps, at least 1
  double variety = 1;      ///< spread of the take-level strength of jaw, lips and expression; 0 = none
  /// What an edit keeps, [N, 55] at 60 fps; null: nothing. What is made anew then goes with it; frames still
  /// come out as the model makes them, for join_kept().
  std::shared_ptr<const KeptValues> kept{};
};

/// Speech in, performance out, while the speech arrives: push samples, pop frames. A frame comes out as soon
/// as look_ahead_ms(model.metadata()) of sound after its instant was pushed; the rest after finish(). The
/// frames do not depend on how the samples were cut into pieces, and animate() is this class in a loop.
/// Memory is constant when frames are popped after every push. One object per performance; not for use by two
/// threads at once.
class DefaultStream {
 public:
  static constexpr double kFps = 60;
  static constexpr std::int64_t kNumChannels = 55;  ///< arkit_and_head_channels()

  DefaultStream(const DefaultModel& model, const PerformOptions& options);
  DefaultStream(DefaultStream&&) noexcept;
  DefaultStream& operator=(DefaultStream&&) noexcept;
  ~DefaultStream();

  /// @param samples  mono at 16 kHz, finite   @pre finish() was not called
  void push(std::span<const float> samples);
  /// The speech is over; round(seconds * 60) frames come out in all.
  void finish();
  /// Writes the next frame and returns true, or returns false when more sound is needed (or all frames were
  /// given).
  bool pop(std::span<float, kNumChannels> frame);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mien
