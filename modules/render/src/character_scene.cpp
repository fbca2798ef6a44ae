#include "mien/render/character_scene.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "mien/base/contract.h"

namespace mien {
namespace {

struct Finish {
  std::string_view word;  // in the name of the part, lower case
  float gloss;
};
// The first word that is found decides: "eyebrow" and "eyelash" come before "eye".
constexpr std::array<Finish, 9> kFinishes = {{{"brow", 0.1f},
                                              {"lash", 0.1f},
                                              {"eye", 0.8f},
                                              {"teeth", 0.5f},
                                              {"tooth", 0.5f},
                                              {"tongue", 0.5f},
                                              {"gum", 0.5f},
                                              {"mouth", 0.5f},
                                              {"hair", 0.25f}}};
constexpr float kSkinGloss = 0.22f;

float gloss_of(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const Finish& finish : kFinishes)
    if (name.find(finish.word) != std::string::npos) return finish.gloss;
  return kSkinGloss;
}

}  // namespace

Scene character_scene(const Character& character, const PosedCharacter& posed) {
  contract(posed.size() == character.parts.size(), "character_scene: one posed part per part expected");
  Scene scene;
  for (std::size_t p = 0; p < posed.size(); ++p) {
    const CharacterPart& part = character.parts[p];
    SceneSurface surface;
    surface.positions = posed[p].positions;
    surface.normals = posed[p].normals;
    surface.triangles = part.mesh.triangles;
    surface.colors = part.mesh.colors;
    surface.gloss = gloss_of(part.name);
    scene.surfaces.push_back(surface);
  }
  return scene;
}

}  // namespace mien
