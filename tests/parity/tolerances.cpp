#include <array>
#include <stdexcept>
#include <string>

#include "closeness.h"

namespace mien::parity {
namespace {

// Float32 stages: what the READMEs of the recorded cases allow or less; largest differences seen are a tenth
// of it or below. Doubles: a few roundings of the recorded value.
constexpr std::array kTolerances = {
    Tolerance{"datasets.scaled", 2e-7, 0, "recorded in double around positions that were rounded to float32"},
    Tolerance{"metrics.error", 1e-8, 2e-7, "sums in double over positions that were rounded to float32"},
    Tolerance{"metrics.take", 1e-7, 1e-6, "the authors' program sums in float32"},
    Tolerance{"metrics.energy", 0, 4e-6, "the authors' program sums the squares of a prediction in float32"},
    Tolerance{"metrics.heat", 2e-9, 2e-6, "the authors' program sums distances of millimetres in float32"},
    Tolerance{"metrics.distance", 2e-7, 0, "positions of size 1 were rounded to float32"},
    Tolerance{"schedule", 1e-15, 2e-12, "double; 1 - alpha_bar loses digits near the clean end"},
    Tolerance{"qp optimum", 1e-8, 0, "double; the recorded optimum is exact to 1e-15"},
    Tolerance{"qp objective", 0, 1e-9, "double"},
    Tolerance{"deformation transfer", 1e-8, 0, "metres, double; recorded with a residual below 1e-9"},
    Tolerance{"deformation transfer energy", 0, 1e-8, "double"},
    Tolerance{"stage", 1e-5, 0, "one network stage in float32, sums in another order"},
    Tolerance{"estimate", 1e-5, 0, "a whole network in float32"},
    Tolerance{"walk", 1e-5, 0, "up to 40 steps; errors do not grow, each step pulls towards its estimate"},
    Tolerance{"motion stage", 1e-4, 0, "float32; latents up to 60; seen 3.1e-5"},
    Tolerance{"motion", 1e-4, 0, "float32, FLAME parameters in the normalised range; seen 1.2e-5"},
    Tolerance{"full-size latent", 2e-3, 0, "float32 behind 24 layers; values up to 14; seen 3.4e-4"},
    Tolerance{"code distance", 1e-4, 1e-5, "float32, of values that are added and taken away again"},
    Tolerance{"code probability", 1e-5, 1e-3, "float32, the exponential of a distance over the temperature"},
    Tolerance{"flame", 3e-7, 0, "metres; recorded in float32; seen 2.3e-8"},
    Tolerance{"ddim walk", 5e-5, 0,
              "100 steps; near the clean end noise is a small difference over a small number; seen 1.2e-5"},
    Tolerance{"encoder", 1e-4, 0, "float32; every stage of the speech encoders; seen 1.5e-5"},
    Tolerance{"encoder in double", 2e-6, 1e-6, "recorded from double as float32"},
    Tolerance{"encoder gradient", 1e-7, 1e-5, "as above; gradients are small"},
    Tolerance{"said noise", 2e-5, 0, "a whole denoiser in float32, and its stages"},
    Tolerance{"said latents", 1e-4, 0, "float32 walks of up to 1000 steps"},
    Tolerance{"said first x0", 3e-4, 0, "noise divided by an alpha of 0.06; seen 1.1e-4"},
    Tolerance{"said result", 5e-5, 0, "float32 walks of up to 1000 steps, clamped"},
    Tolerance{"said sinusoids", 5e-5, 0, "float32 angles up to 999: a unit in the last place is 6e-5"},
    Tolerance{"said gradient norm", 0, 5e-5, "float32, of each tensor and of all; seen 5.0e-6"},
    Tolerance{"said weight norm", 0, 4e-6, "of each tensor after five steps of 1e-3; seen 4.3e-7"},
    Tolerance{"said change norm", 0, 1e-5, "of each tensor's way in five steps of 1e-3; seen 1.3e-6"},
    Tolerance{"said update", 1e-6, 0, "five steps of 1e-3; seen 1.2e-7"},
    Tolerance{"speech features", 5e-5, 0, "float32, behind a whole encoder; seen 9.1e-6"},
    Tolerance{"face loss", 2e-7, 0, "a mean in float32; seen 1.5e-8"},
    Tolerance{"face gradient", 4e-7, 0, "float32, back through a whole encoder; seen 3.4e-8"},
    Tolerance{"motion gradient", 1e-6, 1e-4, "float32, back through two stacks of transformer blocks"},
    Tolerance{"optimiser", 2e-7, 0, "float32; a rounding of a parameter of size 1"},
    Tolerance{"after Adam", 1e-5, 0, "seen 2.1e-6 of 2e-4: Adam divides small gradients by their size"},
    Tolerance{"said code", 1e-4, 0, "float32; values reach 41"},
    Tolerance{"said window", 2e-5, 0, "float32 through both halves of the codec"},
    Tolerance{"said metric", 0, 1e-9, "double"},
    Tolerance{"said metric of few samples", 0, 1e-6, "double; roots of eigenvalues near 0"},
    Tolerance{"said plan", 1e-9, 0, "double"},
    Tolerance{"said loss", 0, 5e-6, "sums over thousands of values in float32; seen 4.5e-7"},
    Tolerance{"encoder waveform", 2e-6, 1e-6, "the recorded statistics are float32 sums"},
};

}  // namespace

const Tolerance& tolerance(std::string_view stage) {
  for (const Tolerance& t : kTolerances)
    if (t.stage == stage) return t;
  throw std::logic_error("no tolerance for the stage '" + std::string(stage) + "'");
}

}  // namespace mien::parity
