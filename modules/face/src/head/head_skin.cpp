#include "head/head_skin.h"

#include <algorithm>
#include <numbers>

#include "head/curves.h"
#include "head/skin_surface.h"

namespace mien::head {
namespace {

// One ring between the lips' outline and their contact line.
struct LipRing {
  double height;         // fraction of the lip's height above the mouth line
  double upper_forward;  // cm in front of the skin
  double lower_forward;
  double towards_contact;  // 0: width of the outline, 1: width of the contact line
};
constexpr std::array<LipRing, 5> kLipRings = {{
    {1.00, 0.06, 0.02, 0.30},  // border of the red of the lips
    {0.74, 0.24, 0.24, 0.50},  // bulge
    {0.45, 0.36, 0.40, 0.70},
    {0.18, 0.27, 0.32, 0.88},
    {0, -0.04, -0.04, 1.0},  // contact line
}};

// The inner sides of the lips behind the contact line, which part as they go back.
struct InnerRing {
  double depth, half_gap, width;  // cm, cm, fraction
};
constexpr std::array<InnerRing, 3> kInnerRings = {
    {{0.30, 0.012, 1.0}, {0.52, 0.06, 0.99}, {0.64, 0.40, 0.99}}};

// The cavity encloses teeth and tongue. `arch`: how much deeper the sides lie than the middle, per cm^2.
struct CavityRing {
  double depth, half_height, half_width, arch;
};
constexpr std::array<CavityRing, 6> kCavityRings = {{{0.70, 1.15, 2.45, 0.26},
                                                     {1.0, 1.62, 2.5, 0.24},
                                                     {2.4, 1.72, 2.35, 0.12},
                                                     {4.2, 1.5, 2.1, 0.05},
                                                     {5.6, 1.0, 1.5, 0},
                                                     {6.3, 0.45, 0.7, 0}}};
constexpr double kThroatDepth = 6.5;
constexpr double kCavityUnderSkin = 0.50;  // thickness of cheeks and chin
constexpr double kCavityY = kMouthLineY - 0.1;

template <std::size_t N>
std::array<std::uint32_t, N> add_ring(HeadSkin& skin, const std::array<Vec3d, N>& ring, Zone zone,
                                      const std::array<std::uint32_t, N>& previous, bool reversed) {
  std::array<std::uint32_t, N> ids{};
  for (std::size_t m = 0; m < N; ++m) ids[m] = static_cast<std::uint32_t>(skin.positions.size() + m);
  skin.positions.insert(skin.positions.end(), ring.begin(), ring.end());
  skin.zones.insert(skin.zones.end(), N, zone);
  for (std::size_t m = 0; m < N; ++m) {
    const auto a = previous[m], b = previous[(m + 1) % N], c = ids[(m + 1) % N], d = ids[m];
    if (reversed) {
      skin.triangles.push_back({a, b, c});
      skin.triangles.push_back({a, c, d});
    } else {
      skin.triangles.push_back({a, d, c});
      skin.triangles.push_back({a, c, b});
    }
  }
  return ids;
}

double squared(double x) { return x * x; }

// ---- mouth

void add_lips(HeadSkin& skin) {
  constexpr double kContactHalfWidth = 2.24;
  MouthLoop& loop = skin.mouth;
  for (std::size_t k = 0; k < kLipRings.size(); ++k) {
    const LipRing& profile = kLipRings[k];
    std::array<Vec3d, kMouthLoop> ring;
    for (std::size_t m = 0; m < ring.size(); ++m) {
      const double s = loop.along[m], a = std::abs(s);
      const bool up = loop.upper[m];
      const double outline_x =
          mouth_outline(static_cast<int>(std::lround(s * kMouthHalfColumns)), Side::upper, 0).x;
      const double contact_x = kContactHalfWidth * (0.55 * std::sin(std::numbers::pi / 2 * s) + 0.45 * s);
      // The upper lip is thinner and dented in the middle (Cupid's bow).
      const double lip_height =
          up ? 0.70 * std::pow(1 - a * a, 0.8) * (1 - 0.13 * std::exp(-squared(s / 0.15)))
             : 0.90 * std::pow(1 - std::pow(a, 2.2), 0.8);
      const double contact_y = kMouthLineY + 0.13 * std::pow(a, 2.2) - 0.05 * std::exp(-squared(s / 0.22));
      const double fullness = std::pow(1 - std::pow(a, 2.6), 0.6);  // 1 in the middle, 0 at the corners
      const double x = outline_x * (1 - profile.towards_contact) + contact_x * profile.towards_contact;
      const double y = contact_y + (up ? 1 : -1) * lip_height * profile.height;
      const double forward = up ? profile.upper_forward : profile.lower_forward;
      const double corner_dent = 0.10 * (1 - fullness) * (static_cast<double>(k) / 4);
      ring[m] = {x, y, skin_z(x, y) + forward * fullness - corner_dent};
    }
    loop.rings[k + 1] = add_ring(skin, ring, Zone::lip, loop.rings[k], false);
  }
}

void add_cavity(HeadSkin& skin) {
  constexpr double kWidestSkin = 3;  // beyond, the skin turns away and would pull the cavity back
  MouthLoop& loop = skin.mouth;
  const MouthRing contact = loop.rings[kContactRing];
  skin.contact_z = skin.positions[contact[kLeftCorner / 2]].z;
  std::size_t next = kContactRing + 1;
  const auto add = [&](const std::array<Vec3d, kMouthLoop>& ring) {
    loop.rings[next] = add_ring(skin, ring, Zone::cavity, loop.rings[next - 1], false);
    ++next;
  };
  for (const InnerRing& inner : kInnerRings) {
    std::array<Vec3d, kMouthLoop> ring;
    for (std::size_t m = 0; m < ring.size(); ++m) {
      const Vec3d c = skin.positions[contact[m]];
      const double a = std::abs(loop.along[m]);
      const double side = a == 1 ? 0 : (loop.upper[m] ? 1 : -1);
      ring[m] = {c.x * inner.width, c.y + side * inner.half_gap * (1 - a * a * a * a), c.z - inner.depth};
    }
    add(ring);
  }
  for (const CavityRing& cavity : kCavityRings) {
    std::array<Vec3d, kMouthLoop> ring;
    for (std::size_t m = 0; m < ring.size(); ++m) {
      const double x = cavity.half_width * std::cos(loop.angle[m]);
      const double y = kCavityY + cavity.half_height * std::sin(loop.angle[m]);
      const double under_skin = skin_z(std::clamp(x, -kWidestSkin, kWidestSkin), y) - kCavityUnderSkin;
      ring[m] = {x, y, std::min(skin.contact_z - cavity.depth - cavity.arch * x * x, under_skin)};
    }
    add(ring);
  }
  skin.throat = static_cast<std::uint32_t>(skin.positions.size());
  skin.positions.push_back({0, kCavityY, skin.contact_z - kThroatDepth});
  skin.zones.push_back(Zone::cavity);
  const MouthRing& last = loop.rings.back();
  for (std::size_t m = 0; m < last.size(); ++m)
    skin.triangles.push_back({last[(m + 1) % last.size()], last[m], skin.throat});
}

void add_mouth(HeadSkin& skin, const SlitGrid& grid) {
  MouthLoop& loop = skin.mouth;
  for (int m = 0; m < kMouthLoop; ++m) {
    const bool up = m <= kLeftCorner;
    const int column = up ? m - kMouthHalfColumns : 3 * kMouthHalfColumns - m;
    const auto i = static_cast<std::size_t>(m);
    loop.along[i] = static_cast<double>(column) / kMouthHalfColumns;
    loop.upper[i] = up;
    loop.angle[i] = up ? std::numbers::pi - std::numbers::pi * m / kLeftCorner
                       : -std::numbers::pi * (m - kLeftCorner) / kLeftCorner;
    loop.rings[0][i] = grid.mouth_vertex(column, up ? Side::upper : Side::lower);
  }
  add_lips(skin);
  add_cavity(skin);
}

// ---- eyes

// How far an eye ring lies between the slit's border (0) and the lid edge (1).
constexpr std::array<double, 6> kLidRings = {0.22, 0.42, 0.58, 0.72, 0.86, 1.0};

double lid_edge_x(double along) { return kEyeCentre.x + 0.02 + 1.44 * along; }
// 1 in the middle of the lid, 0 at the corners.
double lid_openness(double along) { return 1 - std::pow(std::abs(along), 2.3); }

void add_eye(HeadSkin& skin, const SlitGrid& grid, EyeLoopOf& loop) {
  constexpr double kEdgeThickness = 0.11, kEdgeSink = 0.02;
  const double sign = loop.sign;
  std::array<FrontPosition, kEyeLoop> outline;
  for (int m = 0; m < kEyeLoop; ++m) {
    const bool up = m <= kEyeLoop / 2;
    const int column = kEyeFirstColumn + (up ? m : kEyeLoop - m);
    const auto i = static_cast<std::size_t>(m);
    const Side side = up ? Side::upper : Side::lower;
    loop.along[i] = eye_ease(-1 + 2.0 * (column - kEyeFirstColumn) / (kEyeLastColumn - kEyeFirstColumn));
    loop.upper[i] = up;
    loop.rings[0][i] = grid.eye_vertex(loop.sign * column, side);
    outline[i] = eye_outline(column, side);
  }
  // All positions are found for the left eye and mirrored.
  std::array<Vec3d, kEyeLoop> edge;
  std::size_t next = 1;
  const auto add = [&](std::array<Vec3d, kEyeLoop> ring) {
    for (Vec3d& p : ring) p.x *= sign;
    loop.rings[next] = add_ring(skin, ring, Zone::lid, loop.rings[next - 1], loop.sign < 0);
    ++next;
  };
  for (const double t : kLidRings) {
    for (std::size_t m = 0; m < edge.size(); ++m) {
      const double a = loop.along[m], openness = lid_openness(a);
      const bool up = loop.upper[m];
      const double x = outline[m].x * (1 - t) + lid_edge_x(a) * t;
      const double y = outline[m].y * (1 - t) + lid_edge_y(a, up) * t;
      const double crease = up ? 0.09 * gauss(t, 0.44, 0.13) : 0.03 * gauss(t, 0.4, 0.15);
      edge[m] = {x, y, skin_z(x, y) - crease * openness - (t == 1 ? kEdgeSink : 0)};
    }
    add(edge);
  }
  std::array<Vec3d, kEyeLoop> inner;  // the edge's thickness
  for (std::size_t m = 0; m < inner.size(); ++m) {
    const double a = loop.along[m];
    const double rounding = (loop.upper[m] ? -0.035 : 0.05) * lid_openness(a);
    inner[m] = {lid_edge_x(a), lid_edge_y(a, loop.upper[m]) + rounding, edge[m].z - kEdgeThickness};
  }
  add(inner);
  for (std::size_t m = 0; m < inner.size(); ++m) {  // tucked in behind the lid
    const double a = loop.along[m];
    const double x = outline[m].x * 0.45 + lid_edge_x(a) * 0.55;
    const double y = outline[m].y * 0.45 + lid_edge_y(a, loop.upper[m]) * 0.55;
    inner[m] = {x, y, std::min(lid_z(x, y, kEyeRadius + 0.02), edge[m].z + 0.2) - 0.05};
  }
  add(inner);
}

void build_mirror(HeadSkin& skin, const SlitGrid& grid) {
  const auto num_grid = grid.mirror.size();
  skin.mirror.resize(skin.positions.size());
  std::copy(grid.mirror.begin(), grid.mirror.end(), skin.mirror.begin());
  for (std::size_t v = num_grid; v < skin.mirror.size(); ++v) skin.mirror[v] = static_cast<std::uint32_t>(v);
  for (const MouthRing& ring : skin.mouth.rings)
    for (std::size_t m = 0; m < ring.size(); ++m)
      skin.mirror[ring[m]] = ring[m <= kLeftCorner ? kLeftCorner - m : kMouthLoop + kLeftCorner - m];
  for (std::size_t k = 0; k < kNumEyeRings; ++k)
    for (std::size_t m = 0; m < kEyeLoop; ++m) {
      const auto left = skin.eyes[0].rings[k][m], right = skin.eyes[1].rings[k][m];
      skin.mirror[left] = right;
      skin.mirror[right] = left;
    }
}

}  // namespace

double lid_edge_y(double along, bool upper) {
  const double openness = lid_openness(along);
  const double height = upper ? 0.54 * std::pow(openness, 0.75) : -0.42 * std::pow(openness, 0.72);
  return kEyeCentre.y + 0.03 + 0.09 * along + height;
}

HeadSkin build_head_skin(const HeadDesign& design) {
  const SlitGrid grid = build_slit_grid(design);
  HeadSkin skin;
  skin.chart = grid.chart;
  for (const ChartPoint& at : grid.chart) skin.positions.push_back(skin_point(at));
  skin.zones.assign(skin.positions.size(), Zone::grid);
  for (const Quad& q : grid.quads) {
    skin.triangles.push_back({q[0], q[1], q[2]});
    skin.triangles.push_back({q[0], q[2], q[3]});
  }
  skin.triangles.insert(skin.triangles.end(), grid.crown.begin(), grid.crown.end());
  add_mouth(skin, grid);
  skin.eyes[1].sign = -1;
  for (EyeLoopOf& eye : skin.eyes) add_eye(skin, grid, eye);
  build_mirror(skin, grid);
  return skin;
}

}  // namespace mien::head
