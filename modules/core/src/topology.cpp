#include "mien/core/topology.h"

#include <array>

namespace mien {
namespace {

constexpr std::array<KnownTopology, 3> kKnown = {
    {{"biwi", 23370, 25, 0, "scaled (face area or box)"},
     {"flame", 5023, 30, 1000, "metres"},
     {"multiface", 6172, 30, 0, "scaled (each axis to -1 ... 1)"}}};

}  // namespace

std::optional<KnownTopology> known_topology(std::int64_t num_vertices) {
  for (const auto& known : kKnown)
    if (known.num_vertices == num_vertices) return known;
  return std::nullopt;
}

Topology topology_of(std::int64_t num_vertices) {
  const auto known = known_topology(num_vertices);
  return {known ? std::string(known->name) : "", num_vertices};
}

}  // namespace mien
