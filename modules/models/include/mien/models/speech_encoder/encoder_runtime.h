#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "mien/base/result.h"
#include "mien/core/sample_source.h"
#include "mien/io/safetensors.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/models/speech_encoder/speech_statistics.h"
#include "mien/nn/plain_weights.h"
#include "mien/tensor/packed_matrix.h"

namespace mien {

/// How the large products of an encoder are computed. Norms, softmax, GELU, the first convolution, the
/// positional convolution and the attention products are float32 in all of them. docs/performance.md has
/// speed and error.
enum class EncoderPrecision {
  float32,   ///< the bits of a frame do not depend on threads or processor
  bfloat16,  ///< inputs and weights rounded to 16 bits, float32 sums
  int8,      ///< of the layers, weights in 8 bits with a scale per output, inputs with a scale per row; the
         ///< convolutions and the projection as bfloat16 (as float32 on a processor without it), for motion
         ///< answers to them most (docs/performance.md)
};
/// Whether this build and this processor can. float32 always can.
bool encoder_precision_available(EncoderPrecision precision);
/// Who computes the products of its layers.
Backend backend_of(EncoderPrecision precision);

/// Long clips in pieces: each window of frames is encoded with frames of context on both sides, which are
/// thrown away. Waveform normalisation and the norm of the first convolution still see the whole clip, so
/// only attention and positional convolution (64 frames to either side) are cut short.
struct EncoderWindows {
  std::int64_t frames = 0;  ///< kept of each window; 0: the whole clip at once, exact
  std::int64_t left = 0, right = 0;
};

/// Attention over a whole clip grows with the square of its length. Speech longer than this is taken in
/// windows of kLongSpeechWindow_s, with kWindowContext_s heard on either side, unless its caller says
/// otherwise.
inline constexpr double kLongSpeech_s = 60, kLongSpeechWindow_s = 20, kWindowContext_s = 5;
/// Windows of so many seconds at 50 frames a second.
EncoderWindows windows_of(double seconds);
/// "speech of 75 s is taken in windows of 20 s ..."
std::string windows_warning(double speech_s);

struct EncodeOptions {
  int num_threads = 1;
  /// Interpolate to this many frames between convolutions and projection (SAiD); 0: do not.
  std::int64_t num_frames = 0;
  EncoderWindows windows;
  /// For whole clips: called with the input of the first layer (0) and the output of each layer (1 ...).
  std::function<void(std::int64_t, const Tensor&)> on_hidden;
};

/// HuBERT or wav2vec 2.0 for running: the network of network.h with its weights packed once, for speed.
/// Immutable; may be shared by threads.
class EncoderRuntime {
 public:
  /// @pre encoder_precision_available(precision); the weights are loaded
  explicit EncoderRuntime(SpeechEncoder<PlainWeights> weights,
                          EncoderPrecision precision = EncoderPrecision::float32);
  /// Reads the tensors under `prefix`. Errors (Errc::incompatible): as LoadRuntime; a precision that cannot
  /// be had.
  static Result<EncoderRuntime> load(const SafetensorsFile& file, const EncoderConfig& config,
                                     const std::string& prefix = "audio_encoder.",
                                     EncoderPrecision precision = EncoderPrecision::float32);

  [[nodiscard]] const EncoderConfig& config() const;
  /// Mono samples at 16 kHz, as decoded: normalised here if the configuration says so -> [T, D], or
  /// [num_frames, D]. Errors (Errc::input): fewer samples than the first frame sees; samples that are not
  /// finite.
  [[nodiscard]] Result<Tensor> encode(std::span<const float> samples,
                                      const EncodeOptions& options = {}) const;
  /// The same, handing out the frames of each window as they are ready.
  Status encode(std::span<const float> samples, const EncodeOptions& options,
                const std::function<void(const Tensor&)>& sink) const;

  /// The same in two readings, for speech of any length in the memory of a window: hear() what must be known
  /// of the whole, then encode(). Errors: as encode(); those of the source; a source that ends earlier the
  /// second time (input).
  [[nodiscard]] Result<SpeechStatistics> hear(SampleSource& speech) const;
  Status encode(SampleSource& speech, const SpeechStatistics& heard, const EncodeOptions& options,
                const std::function<void(const Tensor&)>& sink) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace mien
