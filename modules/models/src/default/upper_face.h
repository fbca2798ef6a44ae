#pragma once
#include <array>
#include <deque>
#include <vector>

#include "kept_face.h"
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

  /// The past of the first chunk: a standardised face, [45], and what an edit keeps of frame 0.
  void start_from(std::span<const float> standardised_face, const KeptFace* kept = nullptr);
  /// Draws the next chunk. speech [1, 3 W], c [1, C]. What an edit keeps of it (null: nothing) is known at
  /// every step of the diffusion but the last, where the estimate of x0 has it, and to the chunks after it.
  /// frame() gives what was made, for a join to lead it to what is kept.  @pre start_from() was called
  void add_chunk(const Tensor& speech, const Tensor& c, const KeptFace* kept = nullptr);
  /// Frames that can be read: all before this one.
  [[nodiscard]] std::int64_t num_frames() const { return num_chunks_ * kChunkFrames; }
  /// Standardised upper numbers [20] at 60 fps frame n, in order of n; forgets what no later frame needs.
  /// @pre n + 3 < num_frames(), or n % 12 <= 9 and n < num_frames()
  void frame(std::int64_t n, std::span<float> out);

 private:
  void know(const KeptFace::Chunk& known, std::span<const float> last, std::span<float> coefficients) const;
  [[nodiscard]] Tensor sample(const Tensor& h, const Tensor& past, const KeptFace::Chunk& known) const;
  using Sample = std::array<float, kNumUpper>;
  [[nodiscard]] const Sample& sample_at(std::int64_t index) const;

  const DefaultModel model_;
  NoiseField noise_;
  SamplerOptions sampler_;
  std::vector<NoiseLevel> levels_;
  std::vector<Tensor> times_;  // [1, 32] per step
  DiffusionPath<Tensor>::State state_;
  Tensor past_;           // [1, 6 U] standardised samples of the chunk before
  Tensor made_;           // the same as they were made, where an edit keeps others
  bool goes_on_ = false;  // the chunk before was not known entirely
  std::int64_t num_chunks_ = 0;
  std::deque<Sample> samples_;  // 30 fps, from samples_start_ on
  std::int64_t samples_start_ = 0;
};

}  // namespace mien::default_model
