#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "head/slit_grid.h"
#include "head/vec3d.h"

namespace mien::head {

inline constexpr int kMouthLoop =
    48;  ///< vertices of a mouth ring: right corner, upper lip, left corner, lower lip
inline constexpr int kLeftCorner = 24;
inline constexpr int kNumMouthRings = 15;
inline constexpr int kContactRing = 5;  ///< upper and lower copies share one position: the lips are sealed
inline constexpr int kFirstCavityRing = 8;  ///< rings 6 and 7 still belong to the lips' inner side
inline constexpr int kEyeLoop =
    28;  ///< vertices of an eye ring: inner corner, upper lid, outer corner, lower lid
inline constexpr int kNumEyeRings = 9;
inline constexpr int kLidEdgeRing = 6;
inline constexpr double kMouthLineY = -4.12;  ///< cm

using MouthRing = std::array<std::uint32_t, kMouthLoop>;
using EyeRing = std::array<std::uint32_t, kEyeLoop>;

/// Vertex m of every mouth ring lies at `along` in -1 ... 1 (right to left corner) on the upper or the lower
/// lip.
struct MouthLoop {
  std::array<double, kMouthLoop> along{};
  std::array<bool, kMouthLoop> upper{};
  std::array<double, kMouthLoop>
      angle{};  ///< around the cavity: pi at the right corner, 0 at the left, -pi/2 below
  std::array<MouthRing, kNumMouthRings> rings{};  ///< ring 0 is the slit's border
};

/// Vertex m of every ring of an eye lies at `along` in -1 ... 1 (inner to outer corner) on the upper or lower
/// lid.
struct EyeLoopOf {
  int sign = 1;  ///< 1 left, -1 right
  std::array<double, kEyeLoop> along{};
  std::array<bool, kEyeLoop> upper{};
  std::array<EyeRing, kNumEyeRings> rings{};
};

/// Where a vertex of the skin belongs.
enum class Zone : std::uint8_t { grid, lip, cavity, lid };

/// Skin with lips, mouth cavity and lids, cm.
struct HeadSkin {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  std::vector<Zone> zones;            // [V]
  std::vector<std::uint32_t> mirror;  // [V] built from the construction, never from positions
  std::vector<ChartPoint> chart;      // of the grid's vertices, which come first
  MouthLoop mouth;
  std::array<EyeLoopOf, 2> eyes;  // left, right
  std::uint32_t throat = 0;       ///< closes the mouth cavity
  double contact_z = 0;  ///< depth of the contact line in the middle: teeth and tongue are placed from it
};

HeadSkin build_head_skin(const HeadDesign& design);

/// Heights of the lid edges of the left eye at `along`, at rest.
double lid_edge_y(double along, bool upper);

}  // namespace mien::head
