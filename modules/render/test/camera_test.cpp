#include "mien/render/camera.h"

#include <gtest/gtest.h>

#include <limits>

#include "mien/render/rasteriser.h"
#include "shapes.h"

namespace mien {
namespace {

constexpr CameraView kAllViews[] = {CameraView::front, CameraView::portrait, CameraView::three_quarter,
                                    CameraView::side, CameraView::mouth};

Character ball_character() {
  Character character;
  render_test::Solid ball = render_test::ball({0.3f, -2, 0.1f}, 0.1f, 30);
  character.parts.push_back({"skin", {ball.positions, ball.triangles, ball.normals, {}}, {}});
  return character;
}

Image picture(const Character& character, const Camera& camera, int width, int height) {
  SceneSurface s;
  s.positions = character.parts[0].mesh.positions;
  s.triangles = character.parts[0].mesh.triangles;
  RenderOptions options;
  options.width = width, options.height = height;
  return *render({{s}}, camera, options);
}

// Smallest distance from the picture's border of a pixel that differs from the background.
int margin(const Image& image) {
  RenderOptions options;
  options.width = image.width(), options.height = image.height();
  const Image empty = *render({}, {}, options);
  int least = image.width() + image.height();
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (!(image.at(x, y) == empty.at(x, y)))
        least = std::min({least, x, y, image.width() - 1 - x, image.height() - 1 - y});
  return least;
}

TEST(Camera, ViewsHaveNames) {
  for (const CameraView view : kAllViews) EXPECT_EQ(*parse_view(view_name(view)), view);
  const auto wrong = parse_view("fromt");
  ASSERT_FALSE(wrong.has_value());
  EXPECT_EQ(wrong.error().code, Errc::usage);
  EXPECT_NE(wrong.error().fix.find("three-quarter"), std::string::npos);
}

TEST(Camera, FramesTheWholeHeadTightlyInEveryViewAndShape) {
  const Character character = ball_character();
  for (const CameraView view :
       {CameraView::front, CameraView::portrait, CameraView::three_quarter, CameraView::side})
    for (const auto& [w, h] : {std::pair(200, 200), std::pair(300, 150), std::pair(120, 240)}) {
      const Image image =
          picture(character, frame_character(character, view, static_cast<double>(w) / h), w, h);
      EXPECT_GE(margin(image), 1) << view_name(view) << " " << w;
      EXPECT_LE(margin(image), std::min(w, h) / 20) << view_name(view) << " " << w;
    }
}

TEST(Camera, SideViewStandsAtTheCharactersLeft) {
  const Bounds box{{-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}};
  const Camera side = frame_bounds(box, CameraView::side, 1);
  EXPECT_GT(side.position.x, 0.3f);
  EXPECT_NEAR(side.position.z, 0, 1e-5);
  const Camera front = frame_bounds(box, CameraView::front, 1);
  EXPECT_GT(front.position.z, 0.3f);
  EXPECT_NEAR(front.position.x, 0, 1e-5);
}

TEST(Camera, CutsTheNeckBelowTheChin) {
  // A "head" with landmarks: everything below the neck's cut stays outside of the picture.
  Character character = ball_character();
  Mesh& mesh = character.parts[0].mesh;
  std::vector<std::uint32_t> landmarks(68, 0);
  const auto add = [&mesh](Vec3 p) {
    mesh.positions.push_back(p);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  };
  landmarks[8] = add({0.3f, -2.02f, 0.2f}), landmarks[27] = add({0.3f, -1.95f, 0.2f});
  character.regions["landmarks68"] = landmarks;
  const Camera cut = frame_character(character, CameraView::front, 1);
  character.regions.clear();
  const Camera whole = frame_character(character, CameraView::front, 1);
  EXPECT_GT(cut.target.y, whole.target.y + 0.005f);
  EXPECT_LT(cut.position.z, whole.position.z);
}

TEST(Camera, CloseUpFindsTheMouthByRegionOrShape) {
  Character character = ball_character();
  CharacterPart& skin = character.parts[0];
  const std::vector<std::uint32_t> front = {30 * 30, 30 * 30 + 1, 31 * 30};
  Bounds box = *bounds_of(std::array{skin.mesh.positions[front[0]], skin.mesh.positions[front[1]],
                                     skin.mesh.positions[front[2]]});
  const auto looks_at_it = [&box](const Camera& camera) {
    return std::abs(camera.target.x - box.centre().x) < 1e-3f &&
           std::abs(camera.target.y - box.centre().y) < 1e-3f;
  };
  EXPECT_FALSE(looks_at_it(frame_character(character, CameraView::mouth, 1)));
  skin.shapes.push_back({"mouthPucker", front, {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, {}});
  EXPECT_TRUE(looks_at_it(frame_character(character, CameraView::mouth, 1)));
  skin.shapes.clear();
  character.regions["lips"] = front;
  EXPECT_TRUE(looks_at_it(frame_character(character, CameraView::mouth, 1)));
  character.regions["lips"].push_back(4000000);  // a vertex that is not there
  EXPECT_TRUE(looks_at_it(frame_character(character, CameraView::mouth, 1)));
}

TEST(Camera, NothingToFrameGivesAUsableCamera) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Character broken;
  broken.parts.push_back({"skin", {{{nan, 0, 0}, {0, nan, 0}}, {}, {}, {}}, {}});
  Character point;
  point.parts.push_back({"skin", {{{1, 2, 3}}, {}, {}, {}}, {}});
  for (const Character& character : {Character(), broken, point})
    for (const CameraView view : kAllViews) {
      const Camera camera = frame_character(character, view, 1);
      EXPECT_TRUE(std::isfinite(camera.position.x) && std::isfinite(camera.position.z));
      EXPECT_GT(length(camera.target - camera.position), 0);
    }
  EXPECT_FALSE(bounds_of({}).has_value());
}

}  // namespace
}  // namespace mien
