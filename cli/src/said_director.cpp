#include "said_director.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

namespace mien {

void add_said_options(CLI::App& command, SaidWords& said) {
  command
      .add_option("--guidance", said.guidance,
                  "SAiD: how strongly the speech is followed, 0 to 100; up to 1 is none. Default: 2")
      ->check(CLI::Range(0.0, 100.0));
  command
      .add_option("--guidance-rescale", said.rescale,
                  "SAiD: share of guidance that keeps the size of the estimate, 0 to 1. Default: 0")
      ->check(CLI::Range(0.0, 1.0));
  command.add_option("--init", said.init,
                     "SAiD: motion to start from instead of noise (.csv .json .npy .glb)");
  command
      .add_option("--strength", said.strength,
                  "SAiD: how much of the motion of --init is made anew, 0 to 1. Default: 1")
      ->check(CLI::Range(0.0, 1.0));
}

std::string SaidWords::used() const {
  if (guidance) return "--guidance";
  if (rescale) return "--guidance-rescale";
  if (!init.empty()) return "--init";
  return strength ? "--strength" : "";
}

Result<KeptValues> start_values(const Motion& motion, const Motion& model_motion) {
  const Motion even = resample(motion, model_motion.fps);
  Motion start = model_motion;
  start.values.assign(static_cast<std::size_t>(even.num_frames() * start.num_channels()), 0.0f);
  std::string missing, foreign;
  std::int64_t num_found = 0;
  for (std::int64_t c = 0; c < start.num_channels(); ++c) {
    const std::string& name = start.channels[static_cast<std::size_t>(c)];
    const auto from = even.find(name);
    if (!from) {
      missing += (missing.empty() ? "" : ", ") + name;
      continue;
    }
    ++num_found;
    for (std::int64_t n = 0; n < even.num_frames(); ++n)
      start.frame(n)[static_cast<std::size_t>(c)] = even.frame(n)[static_cast<std::size_t>(*from)];
  }
  if (num_found == 0 || even.num_frames() == 0)
    return Error{Errc::incompatible, "motion", "has none of the model's channels, or no frames",
                 "It needs ARKit coefficients such as jawOpen"};
  for (const auto& name : even.channels)
    if (!start.find(name)) foreign += (foreign.empty() ? "" : ", ") + name;
  Result<KeptValues> result{KeptValues(start)};
  if (!missing.empty())
    result.warnings.push_back("the motion to start from lacks " + missing + ": taken as 0");
  if (!foreign.empty()) result.warnings.push_back("the model does not move " + foreign + ": left out");
  return result;
}

std::int64_t trained_steps(const ModelFile& model) { return model.diffusion ? model.diffusion->steps : 1; }

Result<SaidOptions> said_options(const DirectionWords& words, const FaceWords& face, const SaidWords& said,
                                 std::int64_t trained_steps) {
  const auto unfit = [](const std::string& word) {
    return Error{Errc::usage, word, "does not apply to SAiD", "Leave it out"};
  };
  if (!words.emotion.empty()) return unfit("--emotion");
  if (!words.style.empty()) return unfit("--style");
  FaceWords others = face;
  others.eta = 0;
  others.precision.clear();
  others.window_s.reset();
  if (const std::string word = others.used(); !word.empty()) return unfit(word);
  SaidOptions options;
  auto& sampling = options.sampling;
  MIEN_TRY(sampling.sampler, sampler_options(words, face, sampling.sampler));
  sampling.num_steps = face.has_steps ? words.steps : trained_steps;
  sampling.guidance.scale = said.guidance.value_or(sampling.guidance.scale);
  sampling.guidance.rescale = said.rescale.value_or(0.0);
  if (said.strength && said.init.empty())
    return Error{Errc::usage, "--strength", "is how much of a motion to start from is made anew",
                 "Name that motion: --init MOTION"};
  sampling.strength = said.strength.value_or(1.0);
  options.seed = words.seed;
  if (face.window_s && *face.window_s > 0) {
    if (!said.init.empty())
      return Error{Errc::usage, "--window", "and --init exclude each other", "Leave one of them out"};
    const auto window = static_cast<std::int64_t>(std::llround(*face.window_s * kSaidFps));
    options.overlap = std::clamp<std::int64_t>(window / 4, 1, options.overlap);
    options.window = std::max(window, 2 * options.overlap);
  } else if (face.window_s) {
    options.window = 0;
  }
  Result<SaidOptions> result(options);
  if (said.guidance && *said.guidance > 0 && *said.guidance <= 1)
    result.warnings.emplace_back("--guidance up to 1 is no guidance, as in the published program");
  return result;
}

}  // namespace mien
