#pragma once
#include <memory>
#include <vector>

#include "mien/models/facediffuser/folded_denoiser.h"
#include "mien/motion/kept_values.h"

namespace mien::facediffuser {

/// What an edit keeps, as the state y that a FoldedDenoiser carries. A mask P of a frame is a linear map, so
/// an estimate with known values, x0 + P (u - x0), is y0 + A P u - A P x0, and A P x0 = (A P W_out) g + A P
/// (b + neutral) needs no mesh: exact, at the price of one matrix for each different mask.
class KnownFrames {
 public:
  /// @param kept      [N, D]
  /// @param neutrals  [1, D] by lane; of no use to B
  KnownFrames(std::shared_ptr<const FoldedDenoiser> denoiser, const KeptValues& kept,
              std::span<const Tensor> neutrals, int num_threads);

  /// y of noise in frame n at a level: adds alpha A P u. @param y  [state_width]
  void start(std::int64_t n, float alpha, std::span<float> y) const;
  /// An estimate with the known values. @param g  [G] the scaled GRU state that it is made of; y0
  /// [state_width]
  void replace(std::size_t lane, std::int64_t n, std::span<const float> g, std::span<float> y0) const;

 private:
  struct Mask {
    bool is_whole = false;          ///< keeps all: the estimate is the known frame
    PackedMatrix removed;           ///< A P W_out, [state_width, G]
    std::vector<Tensor> constants;  ///< by lane: A P (b + neutral), [1, state_width]
  };
  Mask make_mask(std::span<const float> weights, std::span<const Tensor> neutrals, int num_threads) const;

  std::shared_ptr<const FoldedDenoiser> denoiser_;
  const KeptValues& kept_;
  std::vector<Mask> masks_;         ///< empty for B
  std::vector<std::int64_t> mask_;  ///< by frame: index of its mask; -1: nothing is kept
  std::vector<Tensor> known_;       ///< by frame: A P u, [1, state_width]; empty where nothing is kept
};

}  // namespace mien::facediffuser
