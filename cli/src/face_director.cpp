#include "face_director.h"

#include <CLI/CLI.hpp>
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

void add_face_options(CLI::App& command, DirectionWords& words, FaceWords& face) {
  command
      .add_option("--steps", words.steps,
                  "Diffusion steps, 1 to 1000. Default: 8; published models: all of theirs")
      ->check(CLI::Range(1, 1000))
      ->each([&face](const std::string&) { face.has_steps = true; });
  command
      .add_option("--sampler", words.sampler,
                  "dpm++, ddim or ddpm. Default: dpm++; published models: ddpm, SAiD and the emotional "
                  "FaceDiffuser: ddim")
      ->each([&face](const std::string&) { face.has_sampler = true; });
  command.add_option("--subject", face.subject,
                     "Published models: whose manner and neutral face, one of the model's subjects");
  command.add_option("--template", face.neutral,
                     "Published models: whose neutral face. Default: that of --style");
  command
      .add_option("--skip", face.skip,
                  "Published models: noisiest diffusion steps to leave out. Default: 0; emotional "
                  "FaceDiffuser: 900")
      ->check(CLI::Range(0, 100000));
  command.add_option("--respacing", face.respacing,
                     "Published models: which steps to keep: ddim50, or counts for equal sections: 10,15,20");
  command
      .add_option("--eta", face.eta, "Published models: share of fresh noise with ddim, 0 to 1. Default: 0")
      ->check(CLI::Range(0.0, 1.0));
  command.add_flag("--const-noise", face.same_noise,
                   "Published models: fresh noise of a step is the same in all frames");
  command
      .add_option("--temperature", face.temperature,
                  "ProbTalk3D: how freely codes are drawn; 0 takes the nearest code, the same in every take. "
                  "Default: 0.2; 0.1 to 0.5 are recommended")
      ->check(CLI::Range(0.0, 1e6));
  command.add_option("--draw", face.draw, "ProbTalk3D: take the K-th code of a draw without replacement")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command
      .add_option("--noise", face.noise,
                  "ProbTalk3D's Gaussian variant: deviations from the mean, times this; 0 gives the mean. "
                  "Default: 20")
      ->check(CLI::Range(0.0, 1e6));
  command.add_option("--precision", face.precision,
                     "Published models: numbers of the speech encoder (and of SAiD's denoiser), f32, bf16 or "
                     "int8. Default: f32");
  command
      .add_option(
          "--window", face.window_s,
          "Published models: seconds of speech to encode at once, with 5 s heard on either side; "
          "saves time and memory on long speech and is not exact. SAiD: seconds of motion to make at "
          "once, each from the end of the one before. 0: all of it. Default: all of it up to a minute, "
          "longer speech in windows of 20 s")
      ->check(CLI::Range(0.0, 3600.0));
}

std::string FaceWords::used() const {
  if (!subject.empty()) return "--subject";
  if (!neutral.empty()) return "--template";
  if (!respacing.empty()) return "--respacing";
  if (skip) return "--skip";
  if (eta != 0) return "--eta";
  if (!precision.empty()) return "--precision";
  if (window_s) return "--window";
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

Result<SamplerOptions> sampler_options(const DirectionWords& words, const FaceWords& face,
                                       SamplerOptions options) {
  if (face.has_sampler) {
    const auto sampler = parse_sampler(words.sampler);
    if (!sampler)
      return Error{Errc::usage, "--sampler '" + words.sampler + "'", "is not known",
                   "Known: dpm++, ddim, ddpm"};
    options.kind = *sampler;
  }
  if (face.eta != 0 && options.kind != SamplerKind::ddim)
    return Error{Errc::usage, "--eta", "is of the sampler ddim", "Add --sampler ddim, or leave it out"};
  options.eta = face.eta;
  return options;
}

Result<FaceOptions> face_options(const DirectionWords& words, const FaceWords& face, const ModelFile& model) {
  FaceOptions options = published_options(model);
  // Another choice of steps than the authors' begins with all of them.
  if (face.has_steps || face.has_sampler || !face.respacing.empty()) options.skip = 0;
  options.style = words.style.empty() ? face.subject : words.style;
  options.neutral = face.neutral.empty() ? face.subject : face.neutral;
  options.emotion = words.emotion;
  MIEN_TRY(options.sampler, sampler_options(words, face, options.sampler));
  if (face.has_steps && !face.respacing.empty())
    return Error{Errc::usage, "--steps", "and --respacing both choose the steps", "Leave one of them out"};
  options.respacing = face.has_steps ? std::to_string(words.steps) : face.respacing;
  if (face.skip) options.skip = *face.skip;
  options.same_noise = face.same_noise;
  options.seed = words.seed;
  if (face.temperature) options.draw.temperature = *face.temperature;
  if (face.noise) options.draw.noise_factor = *face.noise;
  options.draw.place = face.draw;
  if (face.window_s) options.windows = *face.window_s > 0 ? windows_of(*face.window_s) : EncoderWindows();
  return options;
}

}  // namespace mien
