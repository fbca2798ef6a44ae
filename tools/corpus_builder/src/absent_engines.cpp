// Stands in for the engines that were not found when the program was configured.
#include "engine.h"

namespace mien {
namespace {

[[maybe_unused]] Error absent(const char* engine, const char* package) {
  return {Errc::failed, engine, "this program was built without it",
          std::string("Install ") + package + " and configure again"};
}

}  // namespace

#ifndef MIEN_HAS_ESPEAK
Result<std::unique_ptr<Engine>> make_espeak() { return absent("espeak", "libespeak-ng-dev"); }
#endif
#ifndef MIEN_HAS_FLITE
Result<std::unique_ptr<Engine>> make_flite() { return absent("flite", "flite1-dev"); }
#endif

}  // namespace mien
