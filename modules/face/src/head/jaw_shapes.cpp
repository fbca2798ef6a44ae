#include <cmath>

#include "head/shapes.h"
#include "mien/base/contract.h"

namespace mien::head {
namespace {

ShapeTarget jaw_target(const ShapeBase& base, const std::string& shape) {
  const auto motion = jaw_motion(shape);
  contract(motion.has_value(), "jaw_target: not a jaw shape");
  return std::move(ShapeTarget(base).jaw(*motion));
}

ShapeTarget jaw_open(const ShapeBase& base) {
  ShapeTarget target = jaw_target(base, "jawOpen");
  const MouthLoop& mouth = base.skin.mouth;
  for (std::size_t m = 0; m < kMouthLoop; ++m) {  // the corners are drawn in
    const double s = mouth.along[m], share = std::pow(std::abs(s), 2.2);
    const double sign = s > 0 ? 1 : s < 0 ? -1 : 0;
    for (std::size_t ring = 0; ring < kFirstCavityRing; ++ring)
      target.add(mouth.rings[ring][m], {-0.30 * sign * share, 0, -0.10 * share});
  }
  target.add_at_handle("cheekLowL", {-0.25, -0.05, -0.10});
  target.add_at_handle("cheekLowR", {0.25, -0.05, -0.10});
  return target;
}

// Undoes the parting of the lips by jawOpen: both contact vertices of a pair are sent to one place between
// them, so that equal coefficients of jawOpen and mouthClose seal the lips exactly.
ShapeTarget mouth_close(const ShapeBase& base, const ShapeTarget& open) {
  constexpr double kUpperShare = 0.42;
  constexpr std::array<double, kFirstCavityRing> kFollow = {0.46, 0.66, 0.82, 0.92, 0.98, 1, 1, 1};
  ShapeTarget target(base);
  const MouthLoop& mouth = base.skin.mouth;
  for (std::size_t ring = 0; ring < kFollow.size(); ++ring)
    for (std::size_t m = 0; m < kMouthLoop; ++m) {
      const std::size_t opposite = m == 0 || m == kLeftCorner ? m : kMouthLoop - m;
      const auto here = mouth.rings[ring][m], there = mouth.rings[ring][opposite];
      const auto upper = mouth.upper[m] ? here : there, lower = mouth.upper[m] ? there : here;
      const Vec3d meet = kUpperShare * open.offsets()[upper] + (1 - kUpperShare) * open.offsets()[lower];
      target.add(here, kFollow[ring] * (meet - open.offsets()[here]));
    }
  return std::move(target.handles({{"chin", {0, 0.05, 0.04}}, {"noseTip", {}}}));
}

}  // namespace

void add_jaw_targets(const ShapeBase& base, ShapeTargets& targets) {
  const ShapeTarget open = jaw_open(base);
  targets.emplace("jawOpen", open);
  targets.emplace("mouthClose", mouth_close(base, open));
  for (const char* shape : {"jawForward", "jawLeft"}) targets.emplace(shape, jaw_target(base, shape));
}

}  // namespace mien::head
