#include <array>

#include "head/lip_curves.h"
#include "head/shapes.h"

namespace mien::head {
namespace {

// Lips to the front and the corners towards the middle; the red turns outwards a little.
ShapeTarget pucker(const ShapeBase& base) {
  const LipOffset outline = [](const LipPlace& lip) {
    const double s2 = lip.along * lip.along;
    return Vec3d{-0.44 * lip.outline_x, 0.02 * (1 - s2) + 0.06 * s2, 0.34 + 0.30 * (1 - s2) + 0.42 * s2};
  };
  const LipOffset contact = [](const LipPlace& lip) {
    const double s2 = lip.along * lip.along;
    return Vec3d{-0.62 * lip.contact_x, 0, 0.62 + 0.10 * (1 - s2) + 0.34 * s2};
  };
  const LipRoll roll = [](const LipPlace& lip, int ring) {
    const double share = gauss(ring, 2.5, 1.3) * (1 - 0.6 * lip.along * lip.along);
    return share * Vec3d{0, lip.upper ? 0.10 : -0.12, 0.10};
  };
  HandleMoves moves =
      on_both({{"nl", {-0.34, 0, 0.16}}, {"ment2", {-0.32, 0.04, 0.14}}, {"cheekLow", {-0.42, 0, 0.06}}});
  moves.insert(moves.end(), {{"sub", {0, 0.02, 0.18}}, {"ment", {0, 0.05, 0.16}}, {"chin", {0, 0.05, 0.05}}});
  return std::move(ShapeTarget(base).lips(outline, contact, roll).handles(moves));
}

// An open ring: lips to the front, apart and turned outwards.
ShapeTarget funnel(const ShapeBase& base) {
  const LipOffset outline = [](const LipPlace& lip) {
    const double s2 = lip.along * lip.along;
    return Vec3d{-0.30 * lip.outline_x, (lip.upper ? 0.20 : -0.26) * (1 - s2),
                 0.30 + 0.30 * (1 - s2) + 0.28 * s2};
  };
  const LipOffset contact = [](const LipPlace& lip) {
    const double s2 = lip.along * lip.along;
    return Vec3d{-0.44 * lip.contact_x, (lip.upper ? 0.42 : -0.46) * std::pow(middle(lip.along, 2.2), 0.8),
                 0.62 + 0.12 * (1 - s2) + 0.20 * s2};
  };
  const LipRoll roll = [](const LipPlace& lip, int ring) {
    const double share = gauss(ring, 2.6, 1.3) * (1 - lip.along * lip.along);
    return share * Vec3d{0, lip.upper ? 0.16 : -0.18, 0.06};
  };
  HandleMoves moves = on_both(
      {{"nl", {-0.22, 0.06, 0.12}}, {"ment2", {-0.22, -0.10, 0.08}}, {"cheekLow", {-0.30, -0.04, 0.04}}});
  moves.insert(moves.end(),
               {{"sub", {0, 0.10, 0.14}}, {"ment", {0, -0.14, 0.10}}, {"chin", {0, -0.05, 0.02}}});
  return std::move(ShapeTarget(base).lips(outline, contact, roll).handles(moves));
}

// One lip rolled in over the teeth: the bulge goes back and towards the contact line.
struct LipRollIn {
  bool upper;
  Vec3d outline, contact;
  double down, back;  // of the roll; `down` is positive towards the contact line of the lower lip
};

ShapeTarget roll_in(const ShapeBase& base, const LipRollIn& in, const HandleMoves& moves) {
  static constexpr std::array<double, kFirstCavityRing> kBack = {0, 0.35, 0.75, 1.0, 1.0, 0.9, 0.7, 0.4};
  static constexpr std::array<double, kFirstCavityRing> kTurn = {0, 1, 1, 0.8, 0.35, 0, 0, 0};
  const auto only = [&in](Vec3d amount) -> LipOffset {
    return [amount, upper = in.upper](const LipPlace& lip) {
      return lip.upper == upper ? middle(lip.along, 4) * amount : Vec3d{};
    };
  };
  const LipRoll roll = [in](const LipPlace& lip, int ring) {
    if (lip.upper != in.upper) return Vec3d{};
    const auto k = static_cast<std::size_t>(ring);
    return (middle(lip.along, 4) * kBack[k]) * Vec3d{0, in.down * kTurn[k], in.back};
  };
  return std::move(ShapeTarget(base).lips(only(in.outline), only(in.contact), roll).handles(moves));
}

ShapeTarget shrug(const ShapeBase& base, std::array<Vec3d, 2> outline, std::array<Vec3d, 2> contact,
                  const HandleMoves& moves) {
  const auto by_lip = [](std::array<Vec3d, 2> upper_lower) -> LipOffset {
    return
        [upper_lower](const LipPlace& lip) { return middle(lip.along, 3) * upper_lower[lip.upper ? 0 : 1]; };
  };
  return std::move(ShapeTarget(base).lips(by_lip(outline), by_lip(contact)).handles(moves));
}

HandleMoves joined(HandleMoves a, const HandleMoves& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

ShapeTarget puff(const ShapeBase& base) {
  const LipOffset outline = [](const LipPlace& lip) {
    return Vec3d{-0.04 * lip.outline_x, 0, 0.16 + 0.12 * lip.along * lip.along};
  };
  const LipOffset contact = [](const LipPlace& lip) {
    return Vec3d{-0.05 * lip.contact_x, 0, 0.05 + 0.06 * lip.along * lip.along};
  };
  return std::move(ShapeTarget(base)
                       .lips(outline, contact)
                       .handles(joined(on_both({{"cheekLow", {0.85, 0, 0.75}},
                                                {"cheekMid", {0.60, 0, 0.45}},
                                                {"nl", {0.14, 0, 0.36}},
                                                {"apple", {0.12, 0, 0.20}},
                                                {"ment2", {0.12, -0.02, 0.30}},
                                                {"jaw2", {0.42, -0.02, 0.25}},
                                                {"jaw1", {0.20, -0.02, 0.25}}}),
                                       {{"ment", {0, 0, 0.22}}, {"sub", {0, 0, 0.14}}})));
}

}  // namespace

void add_lip_targets(const ShapeBase& base, ShapeTargets& targets) {
  targets.emplace("mouthPucker", pucker(base));
  targets.emplace("mouthFunnel", funnel(base));
  targets.emplace("mouthRollUpper", roll_in(base, {true, {0, -0.16, -0.06}, {0, -0.02, -0.05}, -0.36, -0.42},
                                            {{"sub", {0, -0.05, -0.04}}}));
  targets.emplace("mouthRollLower",
                  roll_in(base, {false, {0, 0.24, -0.10}, {0, 0.03, -0.05}, 0.44, -0.46},
                          joined(on_both({{"ment2", {0, 0.07, 0.02}}}), {{"ment", {0, 0.10, 0.02}}})));
  targets.emplace(
      "mouthShrugLower",
      shrug(base, {{{0, 0.14, 0.02}, {0, 0.36, 0.12}}}, {{{0, 0.24, 0.05}, {0, 0.26, 0.12}}},
            joined(on_both({{"ment2", {0, 0.26, 0.04}}, {"chin2", {0, 0.24, 0.04}}}),
                   {{"ment", {0, 0.34, 0.06}}, {"chin", {0, 0.34, 0.08}}, {"sub", {0, 0.05, 0.02}}})));
  targets.emplace(
      "mouthShrugUpper",
      shrug(base, {{{0, 0.28, 0.08}, {0, 0.10, 0.02}}}, {{{0, 0.26, 0.14}, {0, 0.22, 0.06}}},
            joined(on_both({{"nl", {0, 0.10, 0.02}}, {"wing", {0, 0.04, 0}}}), {{"sub", {0, 0.14, 0.05}}})));
  targets.emplace("cheekPuff", puff(base));
}

}  // namespace mien::head
