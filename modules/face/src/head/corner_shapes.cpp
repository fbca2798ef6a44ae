#include "head/lip_curves.h"
#include "head/shapes.h"

namespace mien::head {
namespace {

// A shape that pulls the left mouth corner; towards the right corner the pull fades.
struct CornerPull {
  const char* name;
  Vec3d outline, contact;
  double sharpness;  // above 1: the pull keeps closer to the corner
  HandleMoves handles;
};

std::vector<CornerPull> corner_pulls() {
  return {
      {"mouthSmileLeft",
       {0.62, 0.72, -0.42},
       {0.72, 0.82, -0.50},
       1.0,
       {{"nl", {0.22, 0.42, 0.10}},
        {"apple", {0.10, 0.34, 0.22}},
        {"cheekLow", {0.30, 0.25, -0.05}},
        {"cheekMid", {0.10, 0.14, 0.02}},
        {"infra", {0.02, 0.12, 0.05}},
        {"wing", {0.06, 0.08, -0.03}},
        {"ment2", {0.08, 0.10, -0.03}}}},
      {"mouthFrownLeft",
       {0.12, -0.58, -0.14},
       {0.10, -0.66, -0.12},
       1.2,
       {{"nl", {0.02, -0.16, -0.04}},
        {"ment2", {0.05, -0.22, 0.04}},
        {"cheekLow", {0.03, -0.12, 0}},
        {"chin2", {0, 0.05, 0.05}}}},
      {"mouthDimpleLeft",
       {0.42, 0.06, -0.50},
       {0.46, 0.05, -0.60},
       1.7,
       {{"nl", {0.08, 0.05, -0.02}}, {"cheekLow", {0.18, 0.05, -0.06}}}},
      {"mouthStretchLeft",
       {0.75, -0.12, -0.52},
       {0.82, -0.14, -0.58},
       1.0,
       {{"nl", {0.12, -0.04, -0.04}},
        {"cheekLow", {0.32, -0.06, -0.06}},
        {"ment2", {0.14, -0.10, -0.04}},
        {"jaw2", {0.05, 0, 0}}}},
  };
}

// Moves one lip around the middle of the left half of the mouth.
LipOffset lift(bool upper, Vec3d amount, double width = 0.42, double centre = 0.42) {
  return [=](const LipPlace& lip) {
    if (lip.upper != upper) return Vec3d{};
    return (gauss(lip.along, centre, width) * middle(lip.along, 5)) * amount;
  };
}

ShapeTarget press(const ShapeBase& base) {
  const LipOffset outline = [](const LipPlace& lip) {
    return left_side(lip.along) * Vec3d{0.08, lip.upper ? -0.04 : 0.04, -0.10};
  };
  const LipOffset contact = [](const LipPlace& lip) { return left_side(lip.along) * Vec3d{0.08, 0, -0.12}; };
  const LipRoll roll = [](const LipPlace& lip, int ring) {
    const double share = gauss(lip.along, 0.55, 0.5) * middle(lip.along, 6) * gauss(ring, 2.6, 1.5);
    return share * Vec3d{0, lip.upper ? -0.13 : 0.15, -0.16};
  };
  return std::move(
      ShapeTarget(base).lips(outline, contact, roll).handles(on_left({{"ment2", {0, 0.06, 0.02}}})));
}

// The whole mouth to the left; the left corner leads and is drawn in, the right one follows.
ShapeTarget shift_left(const ShapeBase& base) {
  const auto shift = [](double amount, double depth) -> LipOffset {
    return [=](const LipPlace& lip) {
      const double lead = smooth_step(0, 1, lip.along), trail = smooth_step(0, 1, -lip.along);
      return Vec3d{amount + 0.10 * lead, 0.02 * lead, depth * lead + 0.12 * trail};
    };
  };
  // Both sides move the same way: not mirrored.
  return std::move(ShapeTarget(base)
                       .lips(shift(0.72, -0.28), shift(0.80, -0.30))
                       .handles({{"sub", {0.12, 0, 0}},
                                 {"ment", {0.34, 0, 0}},
                                 {"ment2L", {0.34, 0, 0}},
                                 {"ment2R", {0.34, 0, 0}},
                                 {"chin", {0.08, 0, 0}},
                                 {"nlL", {0.22, 0, 0}},
                                 {"nlR", {0.22, 0, 0}},
                                 {"cheekLowL", {0.22, 0, 0}},
                                 {"cheekLowR", {0.22, 0, 0}}}));
}

}  // namespace

void add_corner_targets(const ShapeBase& base, ShapeTargets& targets) {
  for (const CornerPull& pull : corner_pulls()) {
    const auto along_corner = [&](Vec3d amount) -> LipOffset {
      return [amount, &pull](const LipPlace& lip) {
        return std::pow(left_side(lip.along), pull.sharpness) * amount;
      };
    };
    targets.emplace(pull.name, ShapeTarget(base)
                                   .lips(along_corner(pull.outline), along_corner(pull.contact))
                                   .handles(on_left(pull.handles)));
  }
  targets.emplace(
      "mouthUpperUpLeft",
      ShapeTarget(base)
          .lips(lift(true, {0.05, 0.40, 0.02}), lift(true, {0.05, 0.52, 0.06}))
          .handles(
              on_left({{"nl", {0.04, 0.26, 0.06}}, {"wing", {0.02, 0.10, 0}}, {"apple", {0, 0.10, 0.06}}})));
  targets.emplace("mouthLowerDownLeft",
                  ShapeTarget(base)
                      .lips(lift(false, {0.05, -0.42, 0.04}), lift(false, {0.05, -0.55, 0.08}))
                      .handles(on_left({{"ment2", {0.05, -0.24, -0.02}}, {"chin2", {0.02, -0.05, 0}}})));
  const LipOffset sneer = lift(true, {0.02, 0.16, 0.02}, 0.38, 0.4);
  targets.emplace("noseSneerLeft", ShapeTarget(base)
                                       .lips(sneer, sneer)
                                       .handles(on_left({{"wing", {0.12, 0.30, 0.04}},
                                                         {"nl", {0.02, 0.36, 0.08}},
                                                         {"infra", {-0.05, 0.08, 0.03}},
                                                         {"browIn", {-0.04, -0.14, 0.02}}})));
  targets.emplace("mouthPressLeft", press(base));
  targets.emplace("mouthLeft", shift_left(base));
}

}  // namespace mien::head
