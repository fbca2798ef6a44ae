#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mien {

/// The vertices that a motion of positions moves: how many, in which order. Vertex files of the papers carry
/// no triangles and no name, so two meshes of one size are taken for the same topology.
struct Topology {
  std::string name;               ///< "biwi", "flame", "multiface", "mien_head" ...; empty: unknown
  std::int64_t num_vertices = 0;  ///< V

  friend bool operator==(const Topology&, const Topology&) = default;
};

/// What is known of a topology that the papers use (FaceDiffuser specification, sections 1 and 10).
struct KnownTopology {
  std::string_view name;
  std::int64_t num_vertices;
  double fps;              ///< of the data set, after every second frame of VOCASET was dropped
  double mm_per_unit;      ///< 0: the data set is scaled in a way that has no one length
  std::string_view units;  ///< for people
};

/// "biwi" (23370), "flame" of VOCASET (5023), "multiface" (6172); nothing for another number of vertices.
std::optional<KnownTopology> known_topology(std::int64_t num_vertices);

/// The known topology's name, or none, with the number.
Topology topology_of(std::int64_t num_vertices);

}  // namespace mien
