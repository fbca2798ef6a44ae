#include "head/shapes.h"

namespace mien::head {
namespace {

// A shape of the left lids, brow and cheek.
struct UpperFaceMove {
  const char* name;
  LidMove lids;
  HandleMoves handles;  // without side
};

std::vector<UpperFaceMove> left_moves() {
  return {
      {"cheekSquintLeft",
       {0, 0.10},
       {{"apple", {0.02, 0.42, 0.18}},
        {"infra", {0.02, 0.26, 0.14}},
        {"zyg", {0.05, 0.12, 0.05}},
        {"nl", {0.02, 0.16, 0.03}}}},
      {"browDownLeft",
       {-0.05, 0},
       {{"browIn", {-0.20, -0.38, 0.06}}, {"browMid", {-0.08, -0.36, 0.04}}, {"browOut", {-0.02, -0.16, 0}}}},
      {"browOuterUpLeft",
       {0.03, 0},
       {{"browOut", {0.02, 0.56, -0.06}}, {"browMid", {0.01, 0.36, -0.03}}, {"fore2", {0, 0.20, 0}}}},
      {"eyeBlinkLeft", {0, 0, true}, {}},
      {"eyeSquintLeft", {-0.10, 0.20}, {{"infra", {0.03, 0.14, 0.06}}, {"canthus", {-0.02, 0, 0}}}},
      {"eyeWideLeft", {0.24, -0.06}, {}},
      {"eyeLookUpLeft", {0.17, 0.05}, {}},  // the lids follow the gaze
      {"eyeLookDownLeft", {-0.33, -0.10}, {}},
  };
}

}  // namespace

void add_upper_face_targets(const ShapeBase& base, ShapeTargets& targets) {
  for (const UpperFaceMove& move : left_moves())
    targets.emplace(move.name,
                    ShapeTarget(base).lids(EyeIndex::left, move.lids).handles(on_left(move.handles)));

  HandleMoves brows =
      on_both({{"browIn", {-0.02, 0.56, 0.02}}, {"browMid", {0, 0.28, 0}}, {"fore2", {0, 0.16, 0}}});
  brows.insert(brows.end(), {{"glab", {0, 0.30, 0}}, {"fore", {0, 0.24, 0}}});
  targets.emplace("browInnerUp", ShapeTarget(base).handles(brows));
}

}  // namespace mien::head
