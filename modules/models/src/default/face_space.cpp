#include "mien/models/default/face_space.h"

#include <algorithm>
#include <array>
#include <string>

#include "mien/base/contract.h"
#include "mien/core/arkit.h"

namespace mien {
namespace {

constexpr std::size_t kNumChannels = 55;
constexpr std::size_t kYaw = 52;

constexpr std::array kLowerPairs = {"mouthSmile", "mouthFrown",     "mouthDimple", "mouthStretch",
                                    "mouthPress", "mouthLowerDown", "mouthUpperUp"};
constexpr std::array kLowerSingles = {
    "jawForward",     "jawOpen",         "mouthClose",      "mouthFunnel", "mouthPucker", "mouthRollLower",
    "mouthRollUpper", "mouthShrugLower", "mouthShrugUpper", "cheekPuff",   "tongueOut"};
constexpr std::array kUpperPairs = {"eyeBlink",    "eyeSquint",   "eyeWide",  "browDown",
                                    "browOuterUp", "cheekSquint", "noseSneer"};

struct Pair {
  std::size_t left, right;
};

// Channel indices of the layout in face_space.h.
struct Layout {
  std::array<Pair, 7> lower_pairs, upper_pairs;
  std::array<std::size_t, 11> lower_singles;
  std::size_t brow_inner_up;
  Pair look_out, look_in, look_up, look_down;
};

Pair pair_of(std::string_view stem) {
  return {arkit_index(std::string(stem) + "Left"), arkit_index(std::string(stem) + "Right")};
}

const Layout& layout() {
  static const Layout l = [] {
    Layout made{};
    std::transform(kLowerPairs.begin(), kLowerPairs.end(), made.lower_pairs.begin(), pair_of);
    std::transform(kUpperPairs.begin(), kUpperPairs.end(), made.upper_pairs.begin(), pair_of);
    std::transform(kLowerSingles.begin(), kLowerSingles.end(), made.lower_singles.begin(),
                   [](const char* name) { return arkit_index(name); });
    made.brow_inner_up = arkit_index("browInnerUp");
    made.look_out = pair_of("eyeLookOut");
    made.look_in = pair_of("eyeLookIn");
    made.look_up = pair_of("eyeLookUp");
    made.look_down = pair_of("eyeLookDown");
    return made;
  }();
  return l;
}

}  // namespace

void encode_face(std::span<const float> c, std::span<float> face) {
  contract(c.size() == kNumChannels && face.size() == kNumFace,
           "encode_face: 55 channels and 45 numbers expected");
  const Layout& l = layout();
  std::size_t i = 0;
  const auto put_pairs = [&](const std::array<Pair, 7>& pairs) {
    for (const auto& [left, right] : pairs) {
      face[i++] = 0.5f * (c[left] + c[right]);
      face[i++] = 0.5f * (c[left] - c[right]);
    }
  };
  put_pairs(l.lower_pairs);
  for (const std::size_t single : l.lower_singles) face[i++] = c[single];
  put_pairs(l.upper_pairs);
  face[i++] = c[l.brow_inner_up];
  // Looking to the subject's left turns the left eye out and the right eye in.
  face[i++] =
      0.5f * (c[l.look_out.left] + c[l.look_in.right]) - 0.5f * (c[l.look_in.left] + c[l.look_out.right]);
  face[i++] =
      0.5f * (c[l.look_up.left] + c[l.look_up.right]) - 0.5f * (c[l.look_down.left] + c[l.look_down.right]);
  for (std::size_t angle = 0; angle < 3; ++angle) face[i++] = c[kYaw + angle];
}

void decode_face(std::span<const float> face, std::span<float> c) {
  contract(c.size() == kNumChannels && face.size() == kNumFace,
           "decode_face: 55 channels and 45 numbers expected");
  const Layout& l = layout();
  std::fill(c.begin(), c.end(), 0.0f);
  std::size_t i = 0;
  const auto take_pairs = [&](const std::array<Pair, 7>& pairs) {
    for (const auto& [left, right] : pairs) {
      const float sum = face[i++], difference = face[i++];
      c[left] = sum + difference;
      c[right] = sum - difference;
    }
  };
  take_pairs(l.lower_pairs);
  for (const std::size_t single : l.lower_singles) c[single] = face[i++];
  take_pairs(l.upper_pairs);
  c[l.brow_inner_up] = face[i++];
  const float to_left = face[i++], up = face[i++];
  c[l.look_out.left] = c[l.look_in.right] = to_left;
  c[l.look_in.left] = c[l.look_out.right] = -to_left;
  c[l.look_up.left] = c[l.look_up.right] = up;
  c[l.look_down.left] = c[l.look_down.right] = -up;
  for (std::size_t k = 0; k < kYaw; ++k) c[k] = std::clamp(c[k], 0.0f, 1.0f);
  for (std::size_t angle = 0; angle < 3; ++angle) c[kYaw + angle] = face[i++];
}

}  // namespace mien
