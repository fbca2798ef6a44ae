#include <array>
#include <stdexcept>
#include <string>

#include "closeness.h"

namespace mien::parity {
namespace {

// Float32 stages: what the READMEs of the recorded cases allow or less; largest differences seen are a tenth
// of it or below. Doubles: a few roundings of the recorded value.
constexpr std::array kTolerances = {
    Tolerance{"schedule", 1e-15, 2e-12, "double; 1 - alpha_bar loses digits near the clean end"},
    Tolerance{"qp optimum", 1e-8, 0, "double; the recorded optimum is exact to 1e-15"},
    Tolerance{"qp objective", 0, 1e-9, "double"},
};

}  // namespace

const Tolerance& tolerance(std::string_view stage) {
  for (const Tolerance& t : kTolerances)
    if (t.stage == stage) return t;
  throw std::logic_error("no tolerance for the stage '" + std::string(stage) + "'");
}

}  // namespace mien::parity
