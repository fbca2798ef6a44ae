#include "head/handles.h"

#include <array>

namespace mien::head {
namespace {

struct HandlePlace {
  std::string_view name;
  double x, y;           // cm, left side
  bool guard = false;    // held still unless moved
  double jaw_share = 0;  // share of the jaw's motion
};
constexpr std::array<HandlePlace, 25> kPlaces = {{
    {"noseTip", 0, -0.75, true},
    {"nbridge", 0, 1.6, true},
    {"nasion", 0, 3.2, true},
    {"wing", 1.05, -1.25},  // wing of the nose
    {"sub", 0, -2.35},      // under the nose
    {"nl", 2.35, -1.9},     // fold from nose to mouth
    {"apple", 3.6, -0.5},   // apple of the cheek
    {"zyg", 5.35, 0.6},     // cheekbone
    {"infra", 3.2, 0.95},   // under the eye
    {"browIn", 1.1, 4.45, true},
    {"browMid", 2.8, 4.95, true},
    {"browOut", 4.5, 4.5, true},
    {"fore", 0, 7.2, true},  // forehead
    {"fore2", 3, 7.2, true},
    {"temple", 5.9, 3.6, true},
    {"glab", 0, 4.3, true},  // between the brows
    {"cheekLow", 4.2, -3.4, false, 0.36},
    {"cheekMid", 5.0, -1.5},
    {"chin", 0, -7.4, false, 1},
    {"chin2", 1.7, -7.2, false, 1},
    {"jaw1", 3.3, -6.6, false, 0.95},
    {"jaw2", 4.6, -5.0, false, 0.62},
    {"ment", 0, -6.05, false, 1},  // fold under the lower lip
    {"ment2", 1.9, -5.9, false, 0.97},
    {"canthus", 5.25, 2.75, true},  // outside the outer eye corner
}};

const HandlePlace* find_place(std::string_view name) {
  for (const HandlePlace& place : kPlaces)
    if (name == place.name || (place.x > 0 && name.size() == place.name.size() + 1 &&
                               name.starts_with(place.name) && (name.back() == 'L' || name.back() == 'R')))
      return &place;
  return nullptr;
}

}  // namespace

std::uint32_t nearest_in_front(const HeadSkin& skin, double x, double y, double min_z) {
  std::uint32_t best = 0;
  double least = 1e300;
  for (std::uint32_t v = 0; v < skin.positions.size(); ++v) {
    const Vec3d& p = skin.positions[v];
    if (skin.zones[v] != Zone::grid || p.z < min_z) continue;
    const double d = (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y);
    if (d < least) least = d, best = v;
  }
  return best;
}

Handles find_handles(const HeadSkin& skin) {
  constexpr double kMinZ = 1.0;
  Handles handles;
  for (const HandlePlace& place : kPlaces) {
    const auto vertex = nearest_in_front(skin, place.x, place.y, kMinZ);
    const std::string name(place.name);
    if (place.x > 0) {
      handles[name + "L"] = vertex;
      handles[name + "R"] = skin.mirror[vertex];
    } else {
      handles[name] = vertex;
    }
  }
  return handles;
}

bool is_guard(std::string_view name) {
  const HandlePlace* place = find_place(name);
  return place != nullptr && place->guard;
}

double jaw_share(std::string_view name) {
  const HandlePlace* place = find_place(name);
  return place == nullptr ? 0 : place->jaw_share;
}

}  // namespace mien::head
