#include <cstdlib>

#include "engine.h"
#include "mien/base/hash.h"

namespace mien {
namespace {

struct Engines {
  std::vector<std::unique_ptr<Engine>> present;
  std::vector<std::string> missing;
};

const Engines& engines() {
  static const Engines all = [] {
    Engines e;
    for (auto* make : {&make_espeak, &make_flite, &make_festival}) {
      auto made = make();
      if (made.has_value())
        e.present.push_back(std::move(made).value());
      else
        e.missing.push_back(made.error().message());
    }
    return e;
  }();
  return all;
}

}  // namespace

std::string_view engine_name(EngineId id) {
  switch (id) {
    case EngineId::espeak:
      return "espeak";
    case EngineId::flite:
      return "flite";
    case EngineId::festival:
      return "festival";
  }
  return "";
}

std::vector<Engine*> available_engines(std::vector<std::string>* missing) {
  if (missing != nullptr) *missing = engines().missing;
  std::vector<Engine*> out;
  for (const auto& e : engines().present) out.push_back(e.get());
  return out;
}

void seed_engine_noise(const std::string& text, const std::string& voice) {
  std::srand(static_cast<unsigned>(hash64(text, hash64(voice))));
}

Engine* find_engine(EngineId id) {
  for (const auto& e : engines().present)
    if (e->id() == id) return e.get();
  return nullptr;
}

}  // namespace mien
