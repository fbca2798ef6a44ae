#pragma once
#include <optional>
#include <string>

#include "director.h"
#include "mien/models/face_model.h"

namespace CLI {
class App;
}

namespace mien {

/// The words of the command line that direct published systems beside DirectionWords.
struct FaceWords {
  std::string subject, neutral, respacing;
  std::optional<int> skip;
  double eta = 0;
  bool same_noise = false;
  std::string precision;                     ///< of the speech encoder: "f32", "bf16", "int8"; empty: f32
  std::optional<double> window_s;            ///< of speech that is encoded at once; 0: all of it
  std::optional<double> temperature, noise;  ///< of ProbTalk3D's draws and of its Gaussian variant
  int draw = 1;                              ///< ProbTalk3D: which code of a draw
  /// Whether --steps and --sampler were given: their defaults are those of the default model.
  bool has_steps = false, has_sampler = false;

  /// The first of them that was used, to tell that it does not apply to another model; empty: none.
  [[nodiscard]] std::string used() const;
};

/// --steps, --sampler, and the options of published models alone. Both outlive the command.
void add_face_options(CLI::App& command, DirectionWords& words, FaceWords& face);

/// Errors (Errc::usage): an unknown word, or one that this processor cannot do.
Result<EncoderPrecision> encoder_precision(const FaceWords& face);

/// Errors (Errc::usage): a word that means nothing to this model.
Status check_words(const FaceWords& face, const ModelFile& model);

/// --sampler and --eta on top of a system's own. Errors (Errc::usage): an unknown sampler, --eta without
/// ddim.
Result<SamplerOptions> sampler_options(const DirectionWords& words, const FaceWords& face,
                                       SamplerOptions options);

/// --subject stands for both --style and --template. --steps M is a process of M steps spread evenly; without
/// it the walk is that of published_options(). Errors (Errc::usage): an unknown sampler, words that exclude
/// each other.
Result<FaceOptions> face_options(const DirectionWords& words, const FaceWords& face, const ModelFile& model);

}  // namespace mien
