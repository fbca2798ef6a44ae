#include "default/lip_contact.h"

#include <gtest/gtest.h>

#include <vector>

#include "mien/models/default/face_space.h"

namespace mien::default_model {
namespace {

constexpr std::size_t kSmile = 0, kLowerDown = 10, kFunnel = 17, kPucker = 18;

std::vector<float> open_mouth() {
  std::vector<float> face(kNumFace, 0.0f);
  face[kSmile] = 0.5f;
  face[kFaceJawOpen] = 0.4f;
  face[kLowerDown] = face[kFunnel] = face[kPucker] = 0.3f;
  return face;
}

TEST(LipContact, SealsWhereABilabialIsHeard) {
  auto face = open_mouth();
  correct_lips({.closed_probability = 0.9f}, face);
  EXPECT_LT(face[kFaceJawOpen] - face[kFaceMouthClose], 0);  // pressed
  EXPECT_EQ(face[kLowerDown], 0);
  EXPECT_EQ(face[kFunnel], 0);
  EXPECT_FLOAT_EQ(face[kFaceJawOpen], 0.4f);  // the jaw goes on moving behind closed lips
  EXPECT_FLOAT_EQ(face[kSmile], 0.5f);
}

TEST(LipContact, LeavesOtherSoundsAlone) {
  auto face = open_mouth();
  correct_lips({.closed_probability = 0.02f}, face);
  EXPECT_EQ(face, open_mouth());
}

TEST(LipContact, RestsInSilenceButKeepsAnExpression) {
  auto face = open_mouth();
  correct_lips({.speech = 0}, face);
  EXPECT_EQ(face[kFaceJawOpen], 0);
  EXPECT_EQ(face[kPucker], 0);
  EXPECT_FLOAT_EQ(face[kSmile], 0.5f);
  face = open_mouth();
  correct_lips({.speech = 0, .expression = 1}, face);
  EXPECT_FLOAT_EQ(face[kFaceJawOpen], 0.4f);  // part of the pose
  EXPECT_EQ(face[kPucker], 0);                // speech alone puckers
}

TEST(LipContact, ShutsAtTheEnd) {
  auto face = open_mouth();
  correct_lips({.closed_probability = 0.9f, .expression = 1, .remaining = 0}, face);
  EXPECT_EQ(face[kFaceJawOpen], 0);
  EXPECT_EQ(face[kFaceMouthClose], 0);
}

}  // namespace
}  // namespace mien::default_model
