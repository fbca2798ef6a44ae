// Pictures of the eight standard poses against stored ones. After a wanted change of the head or of the
// light, run this test with MIEN_UPDATE_GOLDEN=1, look at the new pictures, and commit them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "built_head.h"
#include "mien/face/pose.h"
#include "mien/render/camera.h"
#include "mien/render/png.h"
#include "mien/render/rasteriser.h"
#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 144, kHeight = 176;

struct StandardPose {
  const char* name;
  std::vector<std::string> shapes;  // at coefficient 1
};
void PrintTo(const StandardPose& pose, std::ostream* out) { *out << pose.name; }

Image picture(const StandardPose& pose) {
  const Character& head = test::built_head().character;
  PosedCharacter posed;
  Poser(head, pose.shapes).pose(std::vector<float>(pose.shapes.size(), 1.0f), posed);
  Scene scene;
  for (std::size_t p = 0; p < posed.size(); ++p) {
    SceneSurface surface;
    surface.positions = posed[p].positions;
    surface.normals = posed[p].normals;
    surface.triangles = head.parts[p].mesh.triangles;
    surface.colors = head.parts[p].mesh.colors;
    scene.surfaces.push_back(surface);
  }
  RenderOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.supersampling = 2;
  Camera camera;  // fixed: the pictures must not depend on how cameras are framed
  camera.position = {0.24f, 0.0f, 0.78f};
  camera.target = {0.0f, -0.01f, 0.0f};
  return render(scene, camera, options).value();
}

struct Difference {
  double mean = 0;    // over pixels and channels, of 255
  double beyond = 0;  // share of pixels with a channel that differs by more than kPixelTolerance
  Image shown;        // eight times the difference
};
constexpr int kPixelTolerance = 6;

Difference compare(const Image& a, const Image& b) {
  Difference d;
  d.shown = Image(a.width(), a.height());
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const Rgb8 p = a.at(x, y), q = b.at(x, y);
      const std::array<int, 3> off = {std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)};
      const int most = *std::max_element(off.begin(), off.end());
      d.mean += (off[0] + off[1] + off[2]) / 3.0;
      d.beyond += most > kPixelTolerance;
      const auto shade = static_cast<std::uint8_t>(std::min(255, 8 * most));
      d.shown.at(x, y) = {shade, shade, shade};
    }
  const double pixels = static_cast<double>(a.width()) * a.height();
  d.mean /= pixels;
  d.beyond /= pixels;
  return d;
}

class GoldenPose : public testing::TestWithParam<StandardPose> {};

TEST_P(GoldenPose, LooksAsStored) {
  const Image now = picture(GetParam());
  const fs::path stored =
      project_path("tests/data/golden") / (std::string("head_") + GetParam().name + ".png");
  if (std::getenv("MIEN_UPDATE_GOLDEN") != nullptr) {
    ASSERT_TRUE(write_png(stored, now));
    GTEST_SKIP() << "wrote " << stored;
  }
  const auto golden = read_png(stored);
  ASSERT_TRUE(golden) << golden.error().message();
  ASSERT_EQ(golden->width(), kWidth);
  ASSERT_EQ(golden->height(), kHeight);
  const Difference d = compare(now, *golden);
  const bool same = d.mean < 0.3 && d.beyond < 0.002;
  if (!same) {
    const fs::path folder = fs::path(testing::TempDir());
    const fs::path shown = folder / (std::string("difference_") + GetParam().name + ".png");
    ASSERT_TRUE(write_png(shown, d.shown));
    FAIL() << "mean difference " << d.mean << " of 255, " << 100 * d.beyond << " % of the pixels beyond "
           << kPixelTolerance << "; see " << shown << ". If the change is wanted: MIEN_UPDATE_GOLDEN=1";
  }
}

INSTANTIATE_TEST_SUITE_P(StandardPoses, GoldenPose,
                         testing::Values(StandardPose{"neutral", {}}, StandardPose{"jaw_open", {"jawOpen"}},
                                         StandardPose{"pucker", {"mouthPucker"}},
                                         StandardPose{"smile", {"mouthSmileLeft", "mouthSmileRight"}},
                                         StandardPose{"blink", {"eyeBlinkLeft", "eyeBlinkRight"}},
                                         StandardPose{"brows_up", {"browInnerUp"}},
                                         StandardPose{"funnel", {"mouthFunnel"}},
                                         StandardPose{"jaw_closed", {"jawOpen", "mouthClose"}}),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace mien
