#include "head/shape_target.h"

#include <algorithm>
#include <cmath>

#include "head/skin_surface.h"
#include "mien/base/contract.h"

namespace mien::head {
namespace {

// How far lip rings 0 ... 7 follow the contact line instead of the outline.
constexpr std::array<double, kFirstCavityRing> kContactShare = {0, 0.30, 0.52, 0.72, 0.88, 1, 1, 0.9};

// The front of the cavity follows the lips less and less.
struct CavityFollow {
  std::size_t ring;
  double share;
};
constexpr std::array<CavityFollow, 3> kCavityFollow = {{{8, 0.6}, {9, 0.35}, {10, 0.15}}};
constexpr Vec3d kCavityFollowAxes{0.7, 0.5, 1};

// How far lid rings 4 ... 8 follow the edge.
constexpr std::array<CavityFollow, 5> kLidFollow = {{{4, 0.60}, {5, 0.84}, {6, 1}, {7, 1}, {8, 1}}};

// How far cavity rings 8 ... 14 follow the jaw.
constexpr std::array<double, kNumMouthRings - kFirstCavityRing> kJawFollow = {1, 1, 1, 1, 0.75, 0.4, 0.15};

Vec3d scaled(Vec3d a, Vec3d by) { return {a.x * by.x, a.y * by.y, a.z * by.z}; }

LipPlace lip_place(const HeadSkin& skin, std::size_t m) {
  return {skin.mouth.along[m], skin.mouth.upper[m], skin.positions[skin.mouth.rings[0][m]].x,
          skin.positions[skin.mouth.rings[kContactRing][m]].x};
}

// Height by which the lid edge moves.
double edge_move(const LidMove& move, double along, bool upper, double openness) {
  constexpr double kMeetAt = 0.18;   // closed lids meet low, 18 % up from the lower edge
  constexpr double kOverlap = 0.03;  // cm each: no slit of light between them
  if (!move.closed) return (upper ? move.upper : move.lower) * std::pow(openness, 0.8);
  const double low = lid_edge_y(along, false), high = lid_edge_y(along, true);
  const double meet = low + kMeetAt * (high - low);
  return upper ? meet - high - kOverlap * openness : meet - low + kOverlap * openness;
}

}  // namespace

ShapeBase make_shape_base(const HeadSkin& skin) {
  constexpr double kBackAzimuth = 2.0, kScalpStation = 15.0, kNeckStation = 0.6;
  constexpr double kSideAzimuth = 1.5, kSideStation = 9.5;  // around and above the ears
  ShapeBase base{skin, find_handles(skin), std::vector<bool>(skin.positions.size(), false)};
  for (std::size_t v = 0; v < skin.chart.size(); ++v) {
    const double azimuth = std::abs(skin.chart[v].azimuth), station = skin.chart[v].station;
    base.still_or_given[v] = azimuth > kBackAzimuth || station > kScalpStation || station < kNeckStation ||
                             (azimuth > kSideAzimuth && station > kSideStation);
  }
  for (const MouthRing& ring : skin.mouth.rings)
    for (const auto v : ring) base.still_or_given[v] = true;
  base.still_or_given[skin.throat] = true;
  for (const EyeLoopOf& eye : skin.eyes)
    for (const auto& follow : kLidFollow)
      for (const auto v : eye.rings[follow.ring]) base.still_or_given[v] = true;
  return base;
}

HandleMoves on_left(const HandleMoves& moves) {
  HandleMoves out;
  for (const auto& [name, offset] : moves) out.emplace_back(name + "L", offset);
  return out;
}

HandleMoves on_both(const HandleMoves& moves) {
  HandleMoves out = on_left(moves);
  for (const auto& [name, offset] : moves) out.emplace_back(name + "R", mirrored(offset));
  return out;
}

ShapeTarget::ShapeTarget(const ShapeBase& base) : base_(&base), offsets_(base.skin.positions.size()) {
  for (const auto& [name, vertex] : base.handles)
    if (is_guard(name)) held_.insert(name);
}

ShapeTarget& ShapeTarget::handles(const HandleMoves& moves) {
  for (const auto& [name, offset] : moves) {
    const auto found = base_->handles.find(name);
    contract(found != base_->handles.end(), "ShapeTarget: no handle '" + name + "'");
    offsets_[found->second] = offset;
    held_.insert(name);
  }
  return *this;
}

ShapeTarget& ShapeTarget::add_at_handle(const std::string& handle, Vec3d offset) {
  add(base_->handles.at(handle), offset);
  return *this;
}

ShapeTarget& ShapeTarget::lips(const LipOffset& outline, const LipOffset& contact, const LipRoll& roll) {
  const HeadSkin& skin = base_->skin;
  for (std::size_t m = 0; m < kMouthLoop; ++m) {
    const LipPlace place = lip_place(skin, m);
    const Vec3d o = outline(place), c = contact(place);
    for (std::size_t ring = 0; ring < kContactShare.size(); ++ring) {
      Vec3d d = (1 - kContactShare[ring]) * o + kContactShare[ring] * c;
      if (roll) d += roll(place, static_cast<int>(ring));
      offsets_[skin.mouth.rings[ring][m]] = d;
    }
    for (const auto& [ring, share] : kCavityFollow)
      offsets_[skin.mouth.rings[ring][m]] = share * scaled(c, kCavityFollowAxes);
  }
  return *this;
}

ShapeTarget& ShapeTarget::lids(EyeIndex which, const LidMove& move) {
  constexpr double kMaxDepthChange = 0.6;
  const HeadSkin& skin = base_->skin;
  const EyeLoopOf& eye = skin.eyes[static_cast<std::size_t>(which)];
  for (std::size_t m = 0; m < kEyeLoop; ++m) {
    const double openness = 1 - std::pow(std::abs(eye.along[m]), 2.3);
    const double height = edge_move(move, eye.along[m], eye.upper[m], openness);
    for (const auto& [ring, share] : kLidFollow) {
      // The lid slides over the eyeball: its depth is that of the lid surface at the new height.
      const double radius = kEyeRadius + (ring == kNumEyeRings - 1 ? 0.02 : kLidGap);
      const auto vertex = eye.rings[ring][m];
      const Vec3d p = skin.positions[vertex];
      const double dz = lid_z(p.x, p.y + height * share, radius) - lid_z(p.x, p.y, radius);
      offsets_[vertex] +=
          {0, height * share,
           std::clamp(dz, -kMaxDepthChange, kMaxDepthChange) * std::clamp(openness * 3, 0.0, 1.0)};
    }
  }
  return *this;
}

ShapeTarget& ShapeTarget::jaw(const JawMotion& motion) {
  const HeadSkin& skin = base_->skin;
  for (std::size_t m = 0; m < kMouthLoop; ++m) {
    const double a = std::abs(skin.mouth.along[m]), a3 = a * a * a;
    for (std::size_t ring = 0; ring < kFirstCavityRing; ++ring) {
      // Upper and lower share meet at the corners: .36 on the outline, .40 inside of it.
      const double corner = ring == 0 ? 0.36 : 0.40;
      const double share = skin.mouth.upper[m] ? corner * a3 : 1 - (1 - corner) * a3;
      const auto vertex = skin.mouth.rings[ring][m];
      offsets_[vertex] = share * motion(skin.positions[vertex]);
    }
    const double below = 0.5 - 0.5 * std::sin(skin.mouth.angle[m]);
    for (std::size_t k = 0; k < kJawFollow.size(); ++k) {
      const auto vertex = skin.mouth.rings[kFirstCavityRing + k][m];
      offsets_[vertex] = (below * kJawFollow[k]) * motion(skin.positions[vertex]);
    }
  }
  for (const auto& [name, vertex] : base_->handles)
    if (const double share = jaw_share(name); share > 0) {
      offsets_[vertex] = share * motion(skin.positions[vertex]);
      held_.insert(name);
    }
  return *this;
}

}  // namespace mien::head
