#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "mien/models/facediffuser/folded_denoiser.h"
#include "mien/models/facediffuser/plain_sampler.h"

namespace mien::facediffuser {

/// One performance of those that are made side by side.
struct Lane {
  Tensor style;    ///< [1, style_width]: what VertexDenoiser::style gave; empty for B
  Tensor neutral;  ///< [1, D]; empty for B
  /// Of width noise_width, or with `noise_is_data` of width D: noise of the mesh itself, as in recorded
  /// walks. Outlives the FrameDiffusion.
  const FrameNoise* noise = nullptr;
  bool noise_is_data = false;
};

class KnownFrames;

/// Reverse diffusion frame by frame: frame n of the animation comes out as soon as frame n of the speech is
/// known, and does not depend on how the speech was cut.
///
/// A denoiser of FaceDiffuser looks only backwards in time: step s of frame n needs step s - 1 of frame n and
/// the GRU states of step s at frame n - 1. So each step keeps its own GRU state, and the pairs (s, n) with
/// equal s + n are independent: they go through the weights together, as one matrix product per layer instead
/// of one product with a vector for each. Every row is computed alone, so bits do not depend on blocks, lanes
/// or threads.
///
/// Equal to sample_plainly() up to float32 rounding. Memory: states of all steps, and one block of frames.
class FrameDiffusion {
 public:
  /// @pre equal conditions on lanes and denoiser; no clipping of estimates when the denoiser is latent
  FrameDiffusion(std::shared_ptr<const FoldedDenoiser> denoiser, const DiffusionProcess& process,
                 const Walk& walk, std::vector<Lane> lanes, int num_threads = 1);

  /// The next frames of all lanes. @param speech  for each lane aligned features [F, H], F equal
  /// @return for each lane [F, D]
  std::vector<Tensor> next(std::span<const Tensor> speech);

  [[nodiscard]] std::int64_t num_frames() const { return num_frames_; }

 private:
  struct Block;
  void read_speech(std::span<const Tensor> speech, Block& block) const;
  void start(Block& block) const;
  void advance(Block& block, std::int64_t diagonal);
  void advance_rows(Block& block, std::int64_t diagonal, std::int64_t first, std::int64_t count);
  [[nodiscard]] Tensor first_gates(const Block& block, std::int64_t first_item, std::int64_t first_state,
                                   std::int64_t count) const;
  void draw_noise(std::int64_t diagonal, std::int64_t first, std::int64_t count, Tensor& z) const;

  std::shared_ptr<const FoldedDenoiser> denoiser_;
  std::vector<SampleStep> steps_;
  SamplerOptions sampler_;
  float start_scale_ = 1;
  std::vector<Lane> lanes_;
  int num_threads_;
  std::int64_t num_frames_ = 0;
  // Rows of what belongs to steps run from the last step to the first, so that the pairs of a diagonal lie
  // one after the other: row (S - 1 - s) * lanes + lane.
  std::vector<Tensor> states_;                   ///< by layer: [S * lanes, G]
  Tensor step_gates_;                            ///< [S, 3 G]
  std::vector<double> step_sum_, step_squares_;  ///< [S], of the time tokens
  std::vector<Tensor> state_neutral_;            ///< by lane: what is added to an estimate, [1, state_width]
  std::shared_ptr<const KnownFrames> known_;     ///< of an edit; null: nothing
};

}  // namespace mien::facediffuser
