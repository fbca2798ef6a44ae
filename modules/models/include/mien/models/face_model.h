#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/audio_clip.h"
#include "mien/core/motion.h"
#include "mien/core/sample_source.h"
#include "mien/models/frame_sink.h"
#include "mien/models/model_file.h"
#include "mien/models/probtalk3d/draw_options.h"
#include "mien/models/seeds.h"
#include "mien/models/speech_encoder/encoder_runtime.h"
#include "mien/motion/kept_values.h"
#include "mien/motion/sampler.h"

namespace mien {

/// What a performance by a published system may be asked for.
struct FaceOptions {
  std::string style;    ///< whose manner: a subject of the model. Empty: the first
  std::string neutral;  ///< whose neutral face. Empty: the style's own where the file has it, else the first
  /// One of the model's emotions. Empty: the last, as in FaceXHuBERT's program. Models with intensities:
  /// "happy", "happy:3" or "happy:high"; empty: the first, neutral
  std::string emotion;
  SamplerOptions sampler{.kind = SamplerKind::ancestral};
  std::string respacing;         ///< rule for a shorter process (respaced_steps()); empty: all steps
  std::int64_t skip = 0;         ///< noisiest steps to leave out
  bool same_noise = false;       ///< fresh noise of a step is the same in all frames ("const noise")
  probtalk3d::DrawOptions draw;  ///< of ProbTalk3D, which has no diffusion
  std::uint64_t seed = 0;        ///< same seed, same performance
  /// Speech in pieces, which is not exact; frames = 0: at once. Absent: at once up to kLongSpeech_s.
  std::optional<EncoderWindows> windows{};
  /// What an edit keeps, [N, C] of empty_motion() in its units; null: nothing. FaceDiffuser makes the rest to
  /// go with it; frames still come out as the network makes them, for join_kept().
  std::shared_ptr<const KeptValues> kept{};
};

/// A published system, loaded with its speech encoder: FaceXHuBERT, FaceDiffuser or ProbTalk3D. Immutable;
/// may be shared by threads.
class FaceModel {
 public:
  /// Whether animate() below runs models of this architecture.
  static bool runs(Architecture architecture);
  /// Errors: unreadable file (input); another architecture, broken or wrong weights (incompatible).
  static Result<FaceModel> load(const std::filesystem::path& path, int num_threads = 1,
                                EncoderPrecision precision = EncoderPrecision::float32);
  FaceModel(FaceModel&&) noexcept;
  FaceModel& operator=(FaceModel&&) noexcept;
  ~FaceModel();

  [[nodiscard]] const ModelFile& description() const;
  /// A motion of this model without frames.
  [[nodiscard]] Motion empty_motion() const;

  struct Parts;
  [[nodiscard]] const Parts& parts() const { return *parts_; }

 private:
  explicit FaceModel(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// How the authors' program walks: FaceDiffuser's all of its steps, ancestral; the emotional form's the last
/// 100 of its 1000 with DDIM, from little noise, so that its takes hardly differ.
FaceOptions published_options(const ModelFile& model);

/// Speech to motion, `num_takes` performances side by side with the seeds performance_seed(seed, k); frames
/// arrive in blocks of about five seconds, those of ProbTalk3D at once. The speech is read twice, and in
/// windows nothing grows with its length (ProbTalk3D hears at most 200 s, which it holds). Bits do not depend
/// on threads. Errors: a clip shorter than a frame or, for ProbTalk3D, too long (input), words the model does
/// not know (usage), cancelled, those of source and sink.
Status animate(const FaceModel& model, SampleSource& speech, const FaceOptions& options, int num_takes,
               int num_threads, Progress& progress, const FrameSink& sink);
/// One of several recordings, and where its frames go.
struct FaceClip {
  SampleSource* speech;
  FrameSink sink;
};
/// Several recordings: FaceDiffuser walks them side by side through the same weights, which is several times
/// as fast for short ones; features of all are held until then. Each gives the bits that it gives alone.
/// @return of each recording what animate() returns; one that fails takes no other with it
std::vector<Status> animate(const FaceModel& model, std::span<const FaceClip> clips,
                            const FaceOptions& options, int num_takes, int num_threads, Progress& progress);
/// The same with the motions in memory.
Result<std::vector<Motion>> animate(const FaceModel& model, const AudioClip& clip, const FaceOptions& options,
                                    int num_takes, int num_threads, Progress& progress);

}  // namespace mien
