#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/audio_clip.h"
#include "mien/core/motion.h"
#include "mien/models/model_file.h"
#include "mien/models/said/fast_denoiser.h"
#include "mien/models/said/sampling.h"
#include "mien/models/seeds.h"
#include "mien/models/speech_encoder/encoder_runtime.h"

namespace mien {

inline constexpr double kSaidFps = 60;

/// What a performance by SAiD may be asked for.
struct SaidOptions {
  said::SamplingOptions sampling;
  std::uint64_t seed = 0;  ///< same seed, same performance
  /// Values to start from and what to keep of them; see said::Walk. As long as the motion of the clip, or
  /// else of any length, whose frames then look at the speech in proportion.
  const KeptValues* known = nullptr;
  /// Long clips in windows of so many frames: each begins with the last `overlap` frames of the one before,
  /// which it keeps as an edit would, and its noise is that of the same frames in the whole. Memory is that
  /// of a window. Not what the whole clip at once gives, unless it fits one window. 0: all at once. Absent:
  /// at once up to kLongSpeech_s, and with known values, which exclude windows.
  std::optional<std::int64_t> window{};
  std::int64_t overlap = 60;
};

/// SAiD, loaded with its speech encoder. Immutable; may be shared by threads.
class SaidModel {
 public:
  /// Errors: unreadable file (input); another architecture, broken or wrong weights (incompatible).
  static Result<SaidModel> load(const std::filesystem::path& path,
                                EncoderPrecision precision = EncoderPrecision::float32);
  SaidModel(SaidModel&&) noexcept;
  SaidModel& operator=(SaidModel&&) noexcept;
  ~SaidModel();

  [[nodiscard]] const ModelFile& description() const;
  /// A motion of this model without frames: 32 ARKit coefficients at 60 fps.
  [[nodiscard]] Motion empty_motion() const;
  [[nodiscard]] const said::FastDenoiser& denoiser() const;
  [[nodiscard]] const EncoderRuntime& encoder() const;
  /// The steps it was trained with.
  [[nodiscard]] DiffusionProcess process() const;
  /// Context of a clip, [model frames, D] (said::speech_length()). Errors: as said::encode_speech().
  [[nodiscard]] Result<Tensor> context(const AudioClip& clip, int num_threads) const;

 private:
  struct Parts;
  explicit SaidModel(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// Speech to coefficients, `num_takes` performances side by side with the seeds performance_seed(seed, k):
/// clamped to 0 ... 1 and as long as the clip. Noise is addressed by frame and channel. Bits do not depend on
/// threads. Errors: a clip shorter than a frame (input), options out of range (usage), cancelled.
Result<std::vector<Motion>> animate(const SaidModel& model, const AudioClip& clip, const SaidOptions& options,
                                    int num_takes, int num_threads, Progress& progress);

}  // namespace mien
