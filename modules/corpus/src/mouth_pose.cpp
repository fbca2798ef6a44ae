#include <algorithm>

#include "arkit_channels.h"
#include "mien/corpus/articulation.h"

namespace mien {

ArkitFrame mouth_pose(const ArticulatorFrame& mouth, const ArticulationStyle& style) {
  using enum Articulator;
  using namespace channel;
  const float jo = mouth[jaw_open], rd = mouth[round], fn = mouth[funnel], sp = mouth[spread];
  const float ll = mouth[lower_lip], ul = mouth[upper_lip], tg = mouth[tongue], jf = mouth[jaw_thrust];
  const float lc = mouth.closure, lf = mouth.labiodental, pl = mouth.pressure;
  const float open = 1 - lc, open_teeth = open * (1 - 0.8f * lf);
  const auto press = static_cast<float>(style.press);

  ArkitFrame w{};
  w[kJawOpen] = 0.72f * jo;
  w[kMouthFunnel] = 0.80f * fn * open_teeth;
  w[kMouthPucker] = 0.80f * rd * (1 - 0.25f * lc);
  w[kMouthRollLower] = 0.16f * lc + 0.62f * lf;
  w[kMouthRollUpper] = 0.14f * lc;
  w[kMouthShrugLower] = 0.12f * rd + 0.08f * lc + 0.06f * fn;
  w[kMouthShrugUpper] = 0.10f * lc + 0.05f * rd;
  w[kCheekPuff] = 0.10f * pl;
  w[kJawForward] = 0.28f * jf + 0.06f * rd;
  w[kTongueOut] = 0.28f * tg;
  for (const std::size_t side : {kLeft, kRight}) {
    const auto a = static_cast<float>(style.asymmetry);
    const float q = side == kLeft ? 1 + a : 1 - a;
    w[kMouthSmile + side] = 0.18f * sp * q;
    w[kMouthStretch + side] = 0.42f * sp * q * (1 - 0.4f * lc);
    w[kMouthDimple + side] = 0.12f * sp * q + 0.08f * lc;
    w[kMouthPress + side] = (0.38f * lc + 0.10f * pl) * press * q;
    w[kMouthLowerDown + side] = 0.50f * ll * open_teeth * q;
    w[kMouthUpperUp + side] = (0.42f * ul * open + 0.14f * lf) * q;
    w[kCheekSquint + side] = 0.06f * sp * q;
    w[kNoseSneer + side] = 0.04f * ul + 0.03f * lf;
  }
  for (float& value : w) value = std::clamp(value, 0.0f, 1.0f);
  w[kMouthClose] = mouth_close(lc, w[kJawOpen]);
  return w;
}

}  // namespace mien
