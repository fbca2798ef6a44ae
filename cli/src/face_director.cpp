#include "face_director.h"

namespace mien {

std::string FaceWords::used() const {
  if (!subject.empty()) return "--subject";
  if (!neutral.empty()) return "--template";
  if (!respacing.empty()) return "--respacing";
  if (skip != 0) return "--skip";
  if (eta != 0) return "--eta";
  return same_noise ? "--const-noise" : "";
}

Result<FaceOptions> face_options(const DirectionWords& words, const FaceWords& face) {
  FaceOptions options;
  options.style = words.style.empty() ? face.subject : words.style;
  options.neutral = face.neutral.empty() ? face.subject : face.neutral;
  options.emotion = words.emotion;
  const auto sampler = parse_sampler(face.has_sampler ? words.sampler : "ddpm");
  if (!sampler)
    return Error{Errc::usage, "--sampler '" + words.sampler + "'", "is not known",
                 "Known: dpm++, ddim, ddpm"};
  options.sampler.kind = *sampler;
  if (face.eta != 0 && *sampler != SamplerKind::ddim)
    return Error{Errc::usage, "--eta", "is of the sampler ddim", "Add --sampler ddim, or leave it out"};
  options.sampler.eta = face.eta;
  if (face.has_steps && !face.respacing.empty())
    return Error{Errc::usage, "--steps", "and --respacing both choose the steps", "Leave one of them out"};
  options.respacing = face.has_steps ? std::to_string(words.steps) : face.respacing;
  options.skip = face.skip;
  options.same_noise = face.same_noise;
  options.seed = words.seed;
  return options;
}

}  // namespace mien
