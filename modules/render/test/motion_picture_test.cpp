#include "mien/render/motion_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "ball_character.h"
#include "mien/face/vertex_sequence.h"
#include "mien/render/character_scene.h"
#include "mien/render/heat_colors.h"

namespace mien {
namespace {

using render_test::ball_character;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

MotionPictureOptions small(int width, int height) {
  MotionPictureOptions options;
  options.shading.width = width, options.shading.height = height;
  return options;
}

Motion jaw(std::vector<float> values, double fps = 10) {
  return {MotionSpace::arkit, {"jawOpen"}, fps, std::move(values)};
}

Image shot(const Character& character, const Motion& motion, double seconds) {
  return MotionPicture::create(character, {&motion}, small(64, 64)).value().at(seconds);
}

TEST(MotionPicture, InterpolatesInTimeAndHoldsTheEnds) {
  const Character character = ball_character();
  const Motion motion = jaw({0, 1, 0.5f});
  EXPECT_EQ(shot(character, motion, 0.05), shot(character, jaw({0.5f}), 0));
  EXPECT_EQ(shot(character, motion, 0.1), shot(character, jaw({1}), 0));
  EXPECT_FALSE(shot(character, motion, 0.1) == shot(character, motion, 0));
  EXPECT_EQ(shot(character, motion, -5), shot(character, jaw({0}), 0));
  EXPECT_EQ(shot(character, motion, 1e12), shot(character, jaw({0.5f}), 0));
  EXPECT_EQ(shot(character, motion, static_cast<double>(kNan)), shot(character, jaw({0}), 0));
}

TEST(MotionPicture, DrawsVerticesAsTheShapesThatMadeThem) {
  const Character character = ball_character();
  const Motion curves = jaw({0, 1, 0.5f});
  const Motion vertices = vertex_sequence(character, curves).value();
  ASSERT_EQ(vertices.num_frames(), 3);
  for (const double seconds : {0.1, 0.2})  // at rest the character has normals of its own
    EXPECT_EQ(shot(character, vertices, seconds), shot(character, curves, seconds)) << seconds;
  EXPECT_FALSE(shot(character, vertices, 0) == shot(character, vertices, 0.1));
}

TEST(MotionPicture, NoFramesAndBrokenValuesShowTheFaceAtRest) {
  const Character character = ball_character();
  EXPECT_EQ(shot(character, jaw({}), 0), shot(character, jaw({0}), 0));
  EXPECT_EQ(shot(character, jaw({kNan}), 0), shot(character, jaw({0}), 0));
  const Motion nothing = jaw({});
  EXPECT_EQ(MotionPicture::create(character, {&nothing}, small(8, 8)).value().seconds(), 0);
}

TEST(MotionPicture, ShowsMotionsSideBySideWithTheirOwnStrips) {
  const Character character = ball_character();
  const Motion a = jaw({0, 1}), b = jaw({1, 0, 0});
  MotionPictureOptions options = small(60, 50);
  options.strip_height = 40;
  const auto both = MotionPicture::create(character, {&a, &b}, options).value();
  EXPECT_EQ(both.width(), 120);
  EXPECT_EQ(both.height(), 90);
  EXPECT_DOUBLE_EQ(both.seconds(), 0.3);
  const Image picture = both.at(0.1);
  int x = 0;
  for (const Motion* motion : {&a, &b}) {
    const Image one = MotionPicture::create(character, {motion}, options).value().at(0.1);
    Image part(60, 90);
    blit(part, picture, -x, 0);
    EXPECT_EQ(part, one);
    x += 60;
  }
  options.labels = {"truth", "model"};
  EXPECT_FALSE(MotionPicture::create(character, {&a, &b}, options).value().at(0.1) == picture);
}

TEST(MotionPicture, CloseUpOfTheMouthStaysWithTheHead) {
  const Character character = ball_character();
  const Motion still{MotionSpace::arkit, {"jawOpen", "headYaw"}, 10, {1, 0}};
  const Motion turned{MotionSpace::arkit, {"jawOpen", "headYaw"}, 10, {1, 30}};
  for (const CameraView view : {CameraView::mouth, CameraView::front}) {
    MotionPictureOptions options = small(64, 64);
    options.view = view;
    const auto shown = [&](const Motion& motion) {
      return MotionPicture::create(character, {&motion}, options).value().at(0);
    };
    EXPECT_EQ(shown(still) == shown(turned), view == CameraView::mouth);
  }
}

TEST(MotionPicture, SamePictureForAnyNumberOfThreads) {
  const Character character = ball_character();
  const Motion motion = jaw({0.7f});
  const auto picture = MotionPicture::create(character, {&motion}, small(130, 70)).value();
  const Image one = picture.at(0, 1);
  EXPECT_EQ(picture.at(0, 2), one);
  EXPECT_EQ(picture.at(0, 7), one);
}

TEST(MotionPicture, WhatDoesNotFitIsAnErrorOrAWarning) {
  const Character character = ball_character();
  const auto code = [](const Result<MotionPicture>& result) {
    return result.has_value() ? Errc::failed : result.error().code;
  };
  const Motion vertices = vertex_motion({"point", 1}, 30, {0, 0, 0});
  EXPECT_EQ(code(MotionPicture::create(character, {&vertices}, small(8, 8))), Errc::incompatible);
  const auto total = static_cast<std::int64_t>(character.parts[0].mesh.positions.size());
  const Motion nothing = vertex_motion({"ball", total}, 30);
  EXPECT_EQ(code(MotionPicture::create(character, {&nothing}, small(8, 8))), Errc::input);
  Motion stranger{MotionSpace::rig, {"wingFlap"}, 30, {1}};
  const auto unknown = MotionPicture::create(character, {&stranger}, small(8, 8));
  ASSERT_EQ(code(unknown), Errc::incompatible);
  EXPECT_NE(unknown.error().message().find("wingFlap"), std::string::npos);
  const Motion fine = jaw({0});
  EXPECT_EQ(code(MotionPicture::create(Character(), {&fine}, small(8, 8))), Errc::incompatible);
  EXPECT_EQ(code(MotionPicture::create(character, {&fine}, small(0, 8))), Errc::usage);
  EXPECT_EQ(code(MotionPicture::create(character, {&fine, &fine, &fine}, small(4000, 8))), Errc::usage);

  Motion mixed{MotionSpace::arkit, {"jawOpen", "tongueOut"}, 30, {1, 1}};
  const auto result = MotionPicture::create(character, {&mixed}, small(8, 8));
  ASSERT_TRUE(result.has_value());
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_NE(result.warnings[0].find("tongueOut"), std::string::npos);
  EXPECT_EQ(result.warnings[0].find("jawOpen"), std::string::npos);
}

TEST(CharacterScene, EyesShineAndBrowsDoNot) {
  Character character;
  for (const char* name : {"skin", "eyeLeft", "Eyebrow_L", "Hair", "TeethUpper"}) {
    CharacterPart part = ball_character().parts[0];
    part.name = name;
    character.parts.push_back(part);
  }
  const PosedCharacter posed = rest_pose(character);
  const Scene scene = character_scene(character, posed);
  ASSERT_EQ(scene.surfaces.size(), 5u);
  EXPECT_GT(scene.surfaces[1].gloss, 2 * scene.surfaces[0].gloss);
  EXPECT_LT(scene.surfaces[2].gloss, scene.surfaces[0].gloss);
  EXPECT_GT(scene.surfaces[4].gloss, scene.surfaces[3].gloss);
  EXPECT_EQ(scene.surfaces[1].positions.data(), posed[1].positions.data());
}

TEST(CurveStrip, StandsInTimeAndSurvivesBrokenValues) {
  const Motion motion = jaw({0, 1, 0, kNan, 1, std::numeric_limits<float>::infinity(), 0});
  Features mel{{}, 8, 100};
  for (int i = 0; i < 8 * 70; ++i) mel.values.push_back(i % 9 == 0 ? kNan : static_cast<float>(i % 7));
  for (const double start : {-1.0, 0.0, 0.4, 50.0}) {
    CurveStripOptions options;
    options.start_seconds = start, options.seconds = 1, options.playhead_seconds = start + 0.25;
    const Image strip = curve_strip(80, 60, motion, &mel, options);
    ASSERT_EQ(strip.width(), 80);
    ASSERT_EQ(strip.height(), 60);
    EXPECT_GT(strip.at(20, 50).r, strip.at(20, 50).g + 100)
        << start;  // the playhead, a quarter from the left
    // Dark where the sound is, paper where it is not.
    for (const int x : {5, 40, 75}) {
      const double time = start + (x + 0.5) / 80;
      const bool has_sound = time >= 0 && time < 0.695;
      int dark = 0;
      for (int y = 0; y < 24; ++y) dark += strip.at(x, y).g < 180 ? 1 : 0;
      EXPECT_EQ(dark > 10, has_sound) << start << " " << x;
    }
  }
}

TEST(CurveStrip, AHighValueIsDrawnAboveALowOne) {
  const auto blue_row = [](float value) {
    CurveStripOptions options;
    options.seconds = 1;
    const Image image = curve_strip(100, 60, jaw(std::vector<float>(20, value)), nullptr, options);
    for (int y = 12; y < 60; ++y)
      if (image.at(50, y).b > image.at(50, y).r + 60) return y;
    return -1;
  };
  EXPECT_GT(blue_row(0.0f), 50);
  EXPECT_LT(blue_row(1.0f), 15);
  EXPECT_NEAR(blue_row(0.5f), 33, 3);
}

TEST(CurveStrip, NothingToDrawIsNotAnError) {
  const Features nothing;
  EXPECT_EQ(curve_strip(50, 50, Motion{}, nullptr, {}).width(), 50);
  EXPECT_EQ(curve_strip(50, 5, Motion{}, &nothing, {}).height(), 5);
  EXPECT_TRUE(curve_strip(0, 50, Motion{}, nullptr, {}).empty());
  EXPECT_TRUE(curve_strip(50, -1, Motion{}, nullptr, {}).empty());
}

TEST(HeatColors, GrowLighterAndSurviveAnyValue) {
  int last = -1;
  for (const Rgb8& c : heat_table()) {
    const int luma = 2126 * c.r + 7152 * c.g + 722 * c.b;
    EXPECT_GE(luma, last);
    last = luma;
  }
  EXPECT_EQ(heat_color(-3), heat_table()[0]);
  EXPECT_EQ(heat_color(0.5f), heat_table()[128]);
  EXPECT_EQ(heat_color(std::numeric_limits<float>::infinity()), heat_table()[255]);
  EXPECT_EQ(heat_color(kNan), (Rgb8{128, 128, 128}));
  EXPECT_GT(heat_vertex_color(1)[0], heat_vertex_color(0)[0]);
  Image image(100, 30, {255, 255, 255});
  draw_heat_legend(image, 2, 2, 90, 12.5, "mm");
  EXPECT_EQ(image.at(2, 5), heat_table()[0]);
  EXPECT_EQ(image.at(91, 5), heat_table()[255]);
}

}  // namespace
}  // namespace mien
