#include "face_director.h"

#include <algorithm>
#include <cmath>

namespace mien {

namespace {

std::string of_codes(const FaceWords& face) {
  if (face.temperature) return "--temperature";
  if (face.draw != 1) return "--draw";
  return face.noise ? "--noise" : "";
}

std::string of_diffusion(const FaceWords& face) {
  if (!face.respacing.empty()) return "--respacing";
  if (face.skip) return "--skip";
  if (face.eta != 0) return "--eta";
  if (face.same_noise) return "--const-noise";
  if (face.has_steps) return "--steps";
  return face.has_sampler ? "--sampler" : "";
}

}  // namespace

std::string FaceWords::used() const {
  if (!subject.empty()) return "--subject";
  if (!neutral.empty()) return "--template";
  if (!respacing.empty()) return "--respacing";
  if (skip) return "--skip";
  if (eta != 0) return "--eta";
  if (!precision.empty()) return "--precision";
  if (window_s != 0) return "--window";
  if (const std::string word = of_codes(*this); !word.empty()) return word;
  return same_noise ? "--const-noise" : "";
}

Result<EncoderPrecision> encoder_precision(const FaceWords& face) {
  const std::string& word = face.precision;
  EncoderPrecision precision = EncoderPrecision::float32;
  if (word == "bf16") {
    precision = EncoderPrecision::bfloat16;
  } else if (word == "int8") {
    precision = EncoderPrecision::int8;
  } else if (!word.empty() && word != "f32") {
    return Error{Errc::usage, "--precision '" + word + "'", "is not known", "Known: f32, bf16, int8"};
  }
  if (!encoder_precision_available(precision))
    return Error{Errc::usage, "--precision " + word, "needs oneDNN and a processor that can", "Use f32"};
  return precision;
}

Status check_words(const FaceWords& face, const ModelFile& model) {
  const bool draws_codes = model.architecture == Architecture::probtalk3d;
  if (const std::string word = draws_codes ? of_diffusion(face) : of_codes(face); !word.empty())
    return Error{Errc::usage, word,
                 draws_codes ? "does not apply to ProbTalk3D, which has no diffusion"
                             : "does not apply to this model: it is for ProbTalk3D",
                 "Leave it out"};
  if (draws_codes && !face.neutral.empty())
    return Error{Errc::usage, "--template", "does not apply to ProbTalk3D, which moves FLAME's parameters",
                 "Leave it out"};
  return Done{};
}

Result<FaceOptions> face_options(const DirectionWords& words, const FaceWords& face, const ModelFile& model) {
  FaceOptions options = published_options(model);
  // Another choice of steps than the authors' begins with all of them.
  if (face.has_steps || face.has_sampler || !face.respacing.empty()) options.skip = 0;
  options.style = words.style.empty() ? face.subject : words.style;
  options.neutral = face.neutral.empty() ? face.subject : face.neutral;
  options.emotion = words.emotion;
  if (face.has_sampler) {
    const auto sampler = parse_sampler(words.sampler);
    if (!sampler)
      return Error{Errc::usage, "--sampler '" + words.sampler + "'", "is not known",
                   "Known: dpm++, ddim, ddpm"};
    options.sampler.kind = *sampler;
  }
  if (face.eta != 0 && options.sampler.kind != SamplerKind::ddim)
    return Error{Errc::usage, "--eta", "is of the sampler ddim", "Add --sampler ddim, or leave it out"};
  options.sampler.eta = face.eta;
  if (face.has_steps && !face.respacing.empty())
    return Error{Errc::usage, "--steps", "and --respacing both choose the steps", "Leave one of them out"};
  options.respacing = face.has_steps ? std::to_string(words.steps) : face.respacing;
  if (face.skip) options.skip = *face.skip;
  options.same_noise = face.same_noise;
  options.seed = words.seed;
  if (face.temperature) options.draw.temperature = *face.temperature;
  if (face.noise) options.draw.noise_factor = *face.noise;
  options.draw.place = face.draw;
  if (face.window_s > 0) {
    constexpr double kFeaturesPerSecond = 50;
    constexpr std::int64_t kContext = 250;  // 5 s to either side: docs/performance.md, windows
    options.windows = {.frames = std::max<std::int64_t>(1, std::llround(face.window_s * kFeaturesPerSecond)),
                       .left = kContext,
                       .right = kContext};
  }
  return options;
}

}  // namespace mien
