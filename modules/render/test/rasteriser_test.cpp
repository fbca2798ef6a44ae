#include "mien/render/rasteriser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "shapes.h"

namespace mien {
namespace {

using render_test::ball;
using render_test::polygon;
using render_test::scene_of;
using render_test::Solid;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

// Half a metre is half of the picture's height at z = 0.
Camera unit_camera() {
  Camera camera;
  camera.position = {0, 0, 1};
  camera.vertical_fov_deg = 2 * 26.565051f;  // tangent 1/2
  return camera;
}

RenderOptions plain(int width, int height) {
  RenderOptions options;
  options.width = width, options.height = height;
  options.occlusion = false;
  return options;
}

Image drawn(const Scene& scene, const RenderOptions& options, const Camera& camera = unit_camera()) {
  auto image = render(scene, camera, options);
  EXPECT_TRUE(image.has_value());
  return image.has_value() ? *image : Image();
}

int count_changed(const Image& a, const Image& b) {
  int count = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) count += a.at(x, y) == b.at(x, y) ? 0 : 1;
  return count;
}

double linear(std::uint8_t value) { return std::pow(value / 255.0, 2.2); }

TEST(Rasteriser, TriangleCoversTheSamplesInsideAndNothingElse) {
  const RenderOptions options = plain(100, 100);
  const Image empty = drawn({}, options);
  // Corners at pixel positions (10, 10), (90, 10), (10, 70): 2400 pixels of area.
  const Solid t = polygon({{-0.4f, 0.4f, 0}, {-0.4f, -0.2f, 0}, {0.4f, 0.4f, 0}});
  const Image image = drawn(scene_of({&t}), options);
  EXPECT_NEAR(count_changed(image, empty), 2400, 40);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const double px = x + 0.5 - 10, py = y + 0.5 - 10;
      const double inside =
          std::min({px, py, (1 - px / 80 - py / 60) * 48});  // distance from the nearest side
      if (inside > 0.1) {
        EXPECT_FALSE(image.at(x, y) == empty.at(x, y)) << x << " " << y;
      }
      if (inside < -0.1) {
        EXPECT_EQ(image.at(x, y), empty.at(x, y)) << x << " " << y;
      }
    }
}

TEST(Rasteriser, CommonEdgesHaveNoGaps) {
  // A fan of thin triangles around an interior point, corners at odd places: every pixel of the square is
  // covered.
  Solid fan;
  fan.positions.push_back({0.0137f, -0.0211f, 0});
  for (int i = 0; i < 97; ++i) {
    const double a = 6.28318530717959 * i / 97;
    fan.positions.push_back({static_cast<float>(0.45 * std::cos(a)), static_cast<float>(0.45 * std::sin(a)),
                             static_cast<float>(0.2 * std::sin(5 * a))});
  }
  for (std::uint32_t i = 0; i < 97; ++i) fan.triangles.push_back({0, 1 + i, 1 + (i + 1) % 97});
  const RenderOptions options = plain(331, 331);
  const Image empty = drawn({}, options), image = drawn(scene_of({&fan}), options);
  for (int y = 0; y < 331; ++y)
    for (int x = 0; x < 331; ++x)
      if (std::hypot(x - 165.0, y - 165.0) < 100) {
        EXPECT_FALSE(image.at(x, y) == empty.at(x, y)) << x << " " << y;
      }
}

TEST(Rasteriser, SamplesOnACommonEdgeAreDrawn) {
  // The diagonal goes through the centres of pixels, and so do two sides of the square: pixels 16 ... 47 are
  // covered. With 64 pixels on a metre and the camera at z = 1, all corners are exact in binary.
  const float low = -15.5f / 64, high = 16.5f / 64;
  const Solid square = polygon({{low, -high, 0}, {high, -high, 0}, {high, -low, 0}, {low, -low, 0}});
  const RenderOptions options = plain(64, 64);
  const Image empty = drawn({}, options), image = drawn(scene_of({&square}), options);
  for (int y = 18; y < 46; ++y)
    for (int x = 18; x < 46; ++x) EXPECT_FALSE(image.at(x, y) == empty.at(x, y)) << x << " " << y;
}

TEST(Rasteriser, NearerSurfaceHidesTheFartherInAnyOrder) {
  const Solid near =
      polygon({{-0.2f, -0.2f, 0.1f}, {0.2f, -0.2f, 0.1f}, {0, 0.2f, 0.1f}}, {0.9f, 0.05f, 0.05f, 1});
  const Solid far =
      polygon({{-0.4f, -0.4f, -0.1f}, {0.4f, -0.4f, -0.1f}, {0, 0.4f, -0.1f}}, {0.05f, 0.05f, 0.9f, 1});
  const RenderOptions options = plain(64, 64);
  const Image a = drawn(scene_of({&near, &far}), options), b = drawn(scene_of({&far, &near}), options);
  EXPECT_EQ(a, b);
  EXPECT_GT(a.at(32, 34).r, a.at(32, 34).b + 100);  // the near one
  EXPECT_GT(a.at(32, 52).b, a.at(32, 52).r + 100);  // the far one, beside it
}

TEST(Rasteriser, FirstOfTwoSurfacesInOnePlaceIsSeen) {
  const std::vector<Vec3> corners = {{-0.3f, -0.3f, 0}, {0.3f, -0.3f, 0}, {0, 0.3f, 0}};
  const Solid red = polygon(corners, {0.9f, 0, 0, 1}), blue = polygon(corners, {0, 0, 0.9f, 1});
  const RenderOptions options = plain(64, 64);
  EXPECT_EQ(drawn(scene_of({&red, &blue}), options), drawn(scene_of({&red}), options));
  EXPECT_EQ(drawn(scene_of({&blue, &red}), options), drawn(scene_of({&blue}), options));
}

TEST(Rasteriser, SurfacesThatCrossAreSplitWhereTheyMeet) {
  // Planes z = x and z = -x meet at x = 0: to the left the second is nearer.
  const Solid a =
      polygon({{-0.3f, -0.3f, -0.3f}, {0.3f, -0.3f, 0.3f}, {0.3f, 0.3f, 0.3f}, {-0.3f, 0.3f, -0.3f}},
              {0.9f, 0.02f, 0.02f, 1});
  const Solid b =
      polygon({{-0.3f, -0.3f, 0.3f}, {0.3f, -0.3f, -0.3f}, {0.3f, 0.3f, -0.3f}, {-0.3f, 0.3f, 0.3f}},
              {0.02f, 0.02f, 0.9f, 1});
  const Image image = drawn(scene_of({&a, &b}), plain(101, 101));
  EXPECT_GT(image.at(47, 50).b, image.at(47, 50).r);
  EXPECT_GT(image.at(53, 50).r, image.at(53, 50).b);
}

TEST(Rasteriser, InterpolatesInPerspective) {
  // A floor from z = 0.5 (half a metre from the camera) to z = -3: its colour is a ramp in z. Light does not
  // depend on the place on a plane with one normal, so the ratio to the same floor in white is the colour.
  Solid ramp = polygon({{-1, -0.2f, 0.5f}, {1, -0.2f, 0.5f}, {1, -0.2f, -3}, {-1, -0.2f, -3}});
  ramp.normals.assign(4, {0, 1, 0});
  Solid white = ramp;
  for (std::size_t i = 0; i < 4; ++i) {
    const float value = i < 2 ? 0.1f : 0.8f;
    ramp.colors[i] = {value, value, value, 1};
    white.colors[i] = {0.8f, 0.8f, 0.8f, 1};
  }
  const RenderOptions options = plain(200, 200);
  const Image a = drawn(scene_of({&ramp}), options), b = drawn(scene_of({&white}), options);
  int checked = 0;
  for (int y = 115; y < 170; y += 5) {
    const double slope = (y + 0.5 - 100) / 200;  // downwards, per metre of depth
    const double z = 1 - 0.2 / slope;
    if (z > 0.45 || z < -2.9) continue;
    const double expected = 0.1 + 0.7 * (0.5 - z) / 3.5;
    const double found = 0.8 * linear(a.at(100, y).r) / linear(b.at(100, y).r);
    EXPECT_NEAR(found, expected, 0.02 * expected + 0.004) << y;
    ++checked;
  }
  EXPECT_GE(checked, 6);
}

TEST(Rasteriser, BothSidesLookTheSame) {
  Solid front = polygon({{-0.3f, -0.3f, 0}, {0.3f, -0.3f, 0}, {0.1f, 0.3f, 0.1f}});
  Solid back = front;
  for (auto& t : back.triangles) std::swap(t[1], t[2]);
  for (Vec3& n : back.normals) n = -1.0f * n;
  EXPECT_EQ(drawn(scene_of({&front}), plain(64, 64)), drawn(scene_of({&back}), plain(64, 64)));
}

TEST(Rasteriser, SamePictureForAnyNumberOfThreads) {
  const Solid a = ball({0.05f, 0, 0}, 0.3f, 40), b = ball({-0.2f, 0.1f, 0.15f}, 0.15f, 25);
  for (const int supersampling : {1, 2}) {
    RenderOptions options;
    options.width = 213, options.height = 157;  // no multiple of a tile
    options.supersampling = supersampling;
    const Image one = drawn(scene_of({&a, &b}), options);
    for (const int threads : {2, 7}) {
      options.num_threads = threads;
      EXPECT_EQ(drawn(scene_of({&a, &b}), options), one) << threads;
    }
  }
}

TEST(Rasteriser, ReusedMemoryChangesNothing) {
  const Solid a = ball({0.05f, 0, 0}, 0.3f, 40), b = ball({-0.2f, 0.1f, 0.15f}, 0.15f, 25);
  Solid flat = a;
  flat.normals.clear();
  RenderScratch scratch;
  for (const auto& [solid, side] :
       {std::pair<const Solid*, int>(&a, 150), {&b, 60}, {&flat, 90}, {&a, 200}}) {
    RenderOptions options;
    options.width = side, options.height = 2 * side;
    const Scene scene = scene_of({solid});
    EXPECT_EQ(render(scene, unit_camera(), options, &scratch).value(), drawn(scene, options)) << side;
  }
}

TEST(Rasteriser, SupersamplingSmoothsTheOutline) {
  const Solid t = polygon({{-0.4f, -0.4f, 0}, {0.4f, -0.37f, 0}, {0.0f, 0.4f, 0}}, {0, 0, 0, 1});
  RenderOptions options = plain(64, 64);
  const auto shades = [&] {
    const Image image = drawn(scene_of({&t}), options);
    int between = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) between += image.at(x, y).r > 20 && image.at(x, y).r < 150 ? 1 : 0;
    return between;
  };
  EXPECT_EQ(shades(), 0);
  options.supersampling = 2;
  EXPECT_GT(shades(), 40);
}

TEST(Rasteriser, OcclusionDarkensCreasesOnly) {
  // Two walls that meet in a corner along y, 90 degrees, seen from the open side.
  Solid left = polygon({{-0.3f, -0.3f, 0.3f}, {0, -0.3f, 0}, {0, 0.3f, 0}, {-0.3f, 0.3f, 0.3f}});
  Solid right = polygon({{0, -0.3f, 0}, {0.3f, -0.3f, 0.3f}, {0.3f, 0.3f, 0.3f}, {0, 0.3f, 0}});
  left.normals.assign(4, {0.70710678f, 0, 0.70710678f});
  right.normals.assign(4, {-0.70710678f, 0, 0.70710678f});
  RenderOptions options = plain(200, 200);
  const Image open = drawn(scene_of({&left, &right}), options);
  options.occlusion = true;
  options.occlusion_radius_m = 0.1f;  // 20 pixels
  const Image closed = drawn(scene_of({&left, &right}), options);
  for (const int x : {97, 102}) EXPECT_LT(closed.at(x, 100).r + 12, open.at(x, 100).r) << x;
  for (const int x : {60, 140}) EXPECT_NEAR(closed.at(x, 100).r, open.at(x, 100).r, 1) << x;
}

TEST(Rasteriser, NothingToDrawLeavesTheBackground) {
  const RenderOptions options = plain(40, 30);
  const Image empty = drawn({}, options);
  Solid nothing;
  EXPECT_EQ(drawn(scene_of({&nothing}), options), empty);
  Solid points = polygon({{0, 0, 0}, {0.1f, 0, 0}});  // vertices, no triangle
  EXPECT_EQ(drawn(scene_of({&points}), options), empty);
  Solid behind = polygon({{-1, -1, 2}, {1, -1, 2}, {0, 1, 2}});
  EXPECT_EQ(drawn(scene_of({&behind}), options), empty);
  Camera blind;
  blind.target = blind.position;  // looks nowhere
  EXPECT_TRUE(render({}, blind, options).has_value());
}

TEST(Rasteriser, TrianglesWithoutAreaAndBrokenVerticesAreLeftOut) {
  const RenderOptions options = plain(64, 64);
  const Image empty = drawn({}, options);
  for (const std::vector<Vec3>& corners : {std::vector<Vec3>{{0, 0, 0}, {0, 0, 0}, {0.3f, 0, 0}},
                                           std::vector<Vec3>{{-0.3f, 0, 0}, {0, 0, 0}, {0.3f, 0, 0}},
                                           std::vector<Vec3>{{0, 0, 0}, {0.3f, 0, 0}, {kNan, 0.3f, 0}},
                                           std::vector<Vec3>{{0, 0, 0}, {0.3f, 0, 0}, {0, kInf, 0}},
                                           std::vector<Vec3>{{0, 0, -kInf}, {0.3f, 0, 0}, {0, 0.3f, 0}}}) {
    const Solid t = polygon(corners);
    EXPECT_EQ(drawn(scene_of({&t}), options), empty);
  }
  // Broken normals and colours draw something, and only inside.
  Solid t = polygon({{-0.2f, -0.2f, 0}, {0.2f, -0.2f, 0}, {0, 0.2f, 0}});
  t.normals[1] = {kNan, 0, 0};
  t.colors[2] = {kNan, kInf, -1, 1};
  const Image image = drawn(scene_of({&t}), options);
  EXPECT_GT(count_changed(image, empty), 100);
  EXPECT_EQ(image.at(2, 2), empty.at(2, 2));
}

TEST(Rasteriser, SurfaceThatReachesBehindTheCameraIsCutThere) {
  const Solid floor = polygon({{-5, -0.1f, 20}, {5, -0.1f, 20}, {5, -0.1f, -20}, {-5, -0.1f, -20}});
  const RenderOptions options = plain(64, 64);
  const Image empty = drawn({}, options), image = drawn(scene_of({&floor}), options);
  for (int x = 0; x < 64; ++x) {
    EXPECT_FALSE(image.at(x, 63) == empty.at(x, 63)) << x;  // below the horizon
    EXPECT_EQ(image.at(x, 20), empty.at(x, 20)) << x;       // above
  }
}

TEST(Rasteriser, HugeTrianglesSurvive) {
  const Solid wall = polygon({{-1e18f, -1e18f, -5}, {1e18f, -1e18f, -5}, {0, 1e18f, -5}});
  EXPECT_TRUE(render(scene_of({&wall}), unit_camera(), plain(32, 32)).has_value());
}

TEST(Rasteriser, WrongOptionsAreErrors) {
  for (const auto& [width, height, supersampling] :
       {std::array{0, 10, 1}, std::array{10, 0, 1}, std::array{-3, 10, 1}, std::array{10, 100000, 1},
        std::array{10, 10, 0}, std::array{10, 10, 3}}) {
    RenderOptions options = plain(width, height);
    options.supersampling = supersampling;
    const auto image = render({}, unit_camera(), options);
    ASSERT_FALSE(image.has_value());
    EXPECT_EQ(image.error().code, Errc::usage);
  }
  RenderOptions options = plain(10, 10);
  options.occlusion_radius_m = kNan;
  EXPECT_FALSE(render({}, unit_camera(), options).has_value());
}

TEST(Rasteriser, ArraysThatDoNotFitAreOurMistake) {
  Solid t = polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  t.triangles[0][2] = 3;
  EXPECT_THROW((void)render(scene_of({&t}), unit_camera(), plain(8, 8)), std::logic_error);
  t = polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  t.normals.pop_back();
  EXPECT_THROW((void)render(scene_of({&t}), unit_camera(), plain(8, 8)), std::logic_error);
}

}  // namespace
}  // namespace mien
