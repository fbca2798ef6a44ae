#pragma once
#include <array>
#include <deque>
#include <vector>

#include "mien/base/random.h"
#include "mien/models/default/chunk_code.h"
#include "mien/models/default/default_model.h"
#include "mien/motion/sampler.h"

namespace mien::default_model {

/// Diffusion of upper face, gaze and head, chunk after chunk (docs/default_model.md, section 4): one sample
/// of the performance per seed.
class UpperFace {
 public:
  UpperFace(const DefaultModel& model, std::uint64_t seed, const SamplerOptions& sampler, int num_steps);

  /// The past of the first chunk: a standardised face, [45].
  void start_from(std::span<const float> standardised_face);
  /// Draws the next chunk. speech [1, 3 W], c [1, C].  @pre start_from() was called
  void add_chunk(const Tensor& speech, const Tensor& c);
  /// Frames that can be read: all before this one.
  [[nodiscard]] std::int64_t num_frames() const { return num_chunks_ * kChunkFrames; }
  /// Standardised upper numbers [20] at 60 fps frame n, in order of n; forgets what no later frame needs.
  /// @pre n + 3 < num_frames(), or n % 12 <= 9 and n < num_frames()
  void frame(std::int64_t n, std::span<float> out);

 private:
  using Sample = std::array<float, kNumUpper>;
  [[nodiscard]] const Sample& sample_at(std::int64_t index) const;

  const DefaultModel model_;
  NoiseField noise_;
  SamplerOptions sampler_;
  std::vector<NoiseLevel> levels_;
  std::vector<Tensor> times_;  // [1, 32] per step
  DiffusionPath<Tensor>::State state_;
  Tensor past_;  // [1, 6 U] standardised samples of the chunk before
  std::int64_t num_chunks_ = 0;
  std::deque<Sample> samples_;  // 30 fps, from samples_start_ on
  std::int64_t samples_start_ = 0;
};

}  // namespace mien::default_model
