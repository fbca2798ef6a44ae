#include "lip_contact.h"

#include <algorithm>
#include <array>

#include "mien/models/default/face_space.h"

namespace mien::default_model {
namespace {

// Numbers of face_space.h that speech moves and that rest at zero.
constexpr std::array<std::size_t, 15> kSpeechNumbers = {6,  7,  10, 11, 12, 13, 14, 15,
                                                        16, 17, 18, 19, 20, 23, 24};
// Of these, what no expression holds: mouthClose, mouthPucker, tongueOut.
constexpr std::array<std::size_t, 3> kSpeechOnly = {16, 18, 24};

// Numbers that part the lips without moving the jaw: mouthLowerDown, mouthUpperUp, mouthFunnel.
constexpr std::array<std::size_t, 5> kLipOpeners = {10, 11, 12, 13, 17};

// The probability at which a closure begins to be enforced, and the width of the transition. Low, because
// voices that the encoder was not trained on get low probabilities; chosen by contact F1 on the synthetic
// sets ked and slt.
constexpr float kClosureStart = 0.08f, kClosureWidth = 0.15f;
constexpr float kPressed = 0.02f;  // enforced lips are pressed a little, as true closures are

}  // namespace

float smooth_step(float u) {
  u = std::clamp(u, 0.0f, 1.0f);
  return u * u * (3 - 2 * u);
}

void correct_lips(const LipEvidence& e, std::span<float> face) {
  const float keep = e.speech + (1 - e.speech) * e.expression;
  for (const std::size_t i : kSpeechNumbers) {
    const bool speech_only = std::find(kSpeechOnly.begin(), kSpeechOnly.end(), i) != kSpeechOnly.end();
    face[i] *= (speech_only ? e.speech : keep) * e.remaining;
  }
  const float seal = smooth_step((e.closed_probability - kClosureStart) / kClosureWidth) * e.remaining;
  const float jaw_open = std::max(0.0f, face[kFaceJawOpen]);
  if (seal <= 0) return;
  face[kFaceMouthClose] = std::max(face[kFaceMouthClose], seal * (jaw_open + kPressed));
  for (const std::size_t i : kLipOpeners) face[i] *= 1 - seal;
}

}  // namespace mien::default_model
