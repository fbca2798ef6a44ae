#include "mien/face/regions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "built_head.h"

namespace mien {
namespace {

using testing::HasSubstr;

TEST(Regions, DefaultHeadHasLipsUpperFaceAndLandmarks) {
  const Character& head = test::built_head().character;
  EXPECT_EQ(find_region(head, kLipsRegion).value().size(), 288U);
  EXPECT_EQ(find_region(head, kUpperFaceRegion).value().size(), 1763U);
  EXPECT_EQ(find_region(head, kLandmarksRegion).value().size(), 68U);
}

TEST(Regions, LandmarksLieWhereTheirNumbersSay) {
  const Character& head = test::built_head().character;
  const auto marks = find_region(head, kLandmarksRegion).value();
  const auto& p = head.parts.front().mesh.positions;
  const auto at = [&](std::size_t i) { return p[marks[i]]; };
  EXPECT_LT(at(0).x, -0.05f);  // jaw line from the character's right ...
  EXPECT_GT(at(16).x, 0.05f);  // ... to its left
  EXPECT_NEAR(at(8).x, 0, 1e-6);
  for (std::size_t i = 0; i < 17; ++i)
    EXPECT_GT(at(i).y, at(8).y - 0.001f);  // the chin is its lowest point, within 1 mm
  EXPECT_LT(at(17).x, at(21).x);
  EXPECT_LT(at(22).x, at(26).x);
  EXPECT_GT(at(27).y, at(30).y);  // bridge to tip
  EXPECT_LT(at(36).x, at(39).x);
  EXPECT_GT(at(37).y, at(41).y);  // upper lid above the lower one
  EXPECT_LT(at(48).x, at(54).x);  // mouth corners
  EXPECT_GT(at(51).y, at(57).y);
  EXPECT_EQ(at(62), at(66));  // sealed
  EXPECT_NE(marks[62], marks[66]);
}

TEST(Regions, UnknownRegionIsAnErrorThatListsTheKnownOnes) {
  const auto found = find_region(test::built_head().character, "nose");
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, Errc::incompatible);
  EXPECT_THAT(found.error().message(), HasSubstr("landmarks68, lips, upper_face"));
  EXPECT_FALSE(find_region(Character{}, kLipsRegion));
}

TEST(Regions, VertexBeyondTheMeshIsAnError) {
  Character one;
  one.parts.resize(1);
  one.parts.front().mesh.positions.resize(3);
  one.regions["lips"] = {0, 3};
  ASSERT_FALSE(find_region(one, "lips"));
  EXPECT_THAT(find_region(one, "lips").error().message(), HasSubstr("vertex 3 of 3"));
  one.regions["lips"] = {0, 2};
  EXPECT_TRUE(find_region(one, "lips"));
}

TEST(Regions, LipGapNeedsAll68Landmarks) {
  Character one;
  one.parts.resize(1);
  one.parts.front().mesh.positions.resize(3);
  one.regions["landmarks68"] = {0, 1};
  EXPECT_FALSE(lip_gap(one, one.parts.front().mesh.positions));
  one.regions["landmarks68"].resize(68);
  one.regions["landmarks68"][62] = 1;
  one.parts.front().mesh.positions[1] = {0, 0.5f, 0};
  EXPECT_FLOAT_EQ(lip_gap(one, one.parts.front().mesh.positions).value(), 0.5f);
}

}  // namespace
}  // namespace mien
