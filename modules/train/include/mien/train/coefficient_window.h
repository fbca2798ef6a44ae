#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mien/base/random.h"

// What SAiD's denoiser and its codec learn from: windows of sequences of coefficients (specification of SAiD,
// sections 7.1 and 8.1). Letters: N frames of a sequence, K coefficients, S samples of its sound.
namespace mien::train {

/// One recording: coefficients [N, K] at 60 frames a second and, for the denoiser, 16 kHz sound [S] that is
/// not normalised.
struct CoefficientSequence {
  std::string name;
  std::vector<float> coefficients;
  std::vector<float> waveform{};

  [[nodiscard]] std::int64_t num_frames(std::int64_t num_channels) const {
    return static_cast<std::int64_t>(coefficients.size()) / num_channels;
  }
};

/// The batches of an epoch that takes as many windows as there are sequences; the last one is smaller.
struct EpochBatches {
  std::int64_t num_sequences = 1, batch = 1;

  [[nodiscard]] std::int64_t count() const { return (num_sequences + batch - 1) / batch; }
  [[nodiscard]] std::int64_t size(std::int64_t step) const {
    const std::int64_t before = step % count() * batch;
    return num_sequences - before < batch ? num_sequences - before : batch;
  }
};

/// The first frame of a window of `window` frames: uniform from half a window before the sequence to half a
/// window before its end. @pre num_frames, window > 0
std::int64_t draw_window_start(Rng& random, std::int64_t num_frames, std::int64_t window);

/// Frames first ... first + count - 1 of a sequence [N, K]; the first and the last frame go on outside it
/// (specification of SAiD, section 7.1). @pre N > 0
std::vector<float> replicated_window(std::span<const float> sequence, std::int64_t num_channels,
                                     std::int64_t first, std::int64_t count);

/// Where each coefficient of a mirrored face comes from: the one of the other side for names that end in Left
/// and Right, else itself. mirrored[k] = original[result[k]].
std::vector<std::size_t> mirror_order(std::span<const std::string> names);

/// In place, [N, K]. @pre K == order.size()
void mirror_coefficients(std::span<float> sequence, std::span<const std::size_t> order);

}  // namespace mien::train
