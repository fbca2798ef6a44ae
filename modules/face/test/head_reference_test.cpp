// The head against numbers of an independent implementation of the same construction.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "built_head.h"
#include "head/base_surface.h"
#include "head/skin_surface.h"
#include "head/tables.h"
#include "mien/face/regions.h"
#include "mien/io/safetensors.h"
#include "test_paths.h"

namespace mien {
namespace {

using head::Offsets;
using test::built_head;
using test::reference_model;

// Trusted tensors of a reference file.
class Reference {
 public:
  explicit Reference(const std::filesystem::path& path)
      : file_(std::move(SafetensorsFile::open(path)).value()) {}
  [[nodiscard]] bool has(const std::string& name) const { return file_.find(name) != nullptr; }
  [[nodiscard]] std::span<const float> floats(const std::string& name) const {
    return file_.as<float>(name).value();
  }
  [[nodiscard]] std::span<const std::int32_t> ints(const std::string& name) const {
    return file_.as<std::int32_t>(name).value();
  }

 private:
  SafetensorsFile file_;
};

constexpr double kToleranceMetres = 1e-7;  // measured: 8e-9, the rounding of the file's floats
constexpr double kToleranceColor = 1e-6;

std::vector<std::uint32_t> all_or_sampled(const Reference& file, const head::MovingPart& part) {
  std::vector<std::uint32_t> vertices;
  if (file.has(part.name + ".sample")) {
    for (const auto v : file.ints(part.name + ".sample")) vertices.push_back(static_cast<std::uint32_t>(v));
  } else {
    for (std::uint32_t v = 0; v < part.mesh.positions.size(); ++v) vertices.push_back(v);
  }
  return vertices;
}

// Largest distance between our vectors (cm) at `vertices` and the file's rows (metres).
double worst(const std::vector<head::Vec3d>& ours, const std::vector<std::uint32_t>& vertices,
             std::span<const float> rows) {
  EXPECT_EQ(rows.size(), 3 * vertices.size());
  double largest = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const head::Vec3d p = ours.at(vertices[i]);
    const head::Vec3d d{0.01 * p.x - rows[3 * i], 0.0094 * p.y - rows[3 * i + 1],
                        0.01 * p.z - rows[3 * i + 2]};
    largest = std::max(largest, length(d));
  }
  return largest;
}

std::vector<std::int32_t> as_ints(const std::vector<std::uint32_t>& v) { return {v.begin(), v.end()}; }
std::vector<std::int32_t> as_ints(std::span<const std::int32_t> v) { return {v.begin(), v.end()}; }

// The same triangle written from its smallest vertex.
std::array<std::int32_t, 3> canonical(std::array<std::int32_t, 3> t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

void compare_with(const Reference& file) {
  double worst_color = 0;
  std::size_t num_shapes = 0;
  for (const head::MovingPart& part : reference_model().parts) {
    if (part.name.starts_with("eyeCorners") || part.name.starts_with("lashes")) continue;  // ours alone
    SCOPED_TRACE(part.name);
    const auto vertices = all_or_sampled(file, part);
    const double off = worst(part.mesh.positions, vertices, file.floats(part.name + ".positions"));
    EXPECT_LT(off, kToleranceMetres);
    const auto colors = file.floats(part.name + ".colours");
    for (std::size_t i = 0; i < vertices.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        worst_color = std::max(worst_color, std::abs(part.mesh.colors[vertices[i]][c] - colors[3 * i + c]));
    for (std::size_t k = 0; k < kNumArkit; ++k) {
      const std::string name = part.name + ".shape." + std::string(arkit_names()[k]);
      const bool ours = k < part.shapes.size() && !part.shapes[k].empty();
      const std::vector<head::Vec3d> still(part.mesh.positions.size());
      const std::vector<float> zeros(3 * vertices.size());
      const double off_shape = worst(ours ? part.shapes[k] : still, vertices,
                                     file.has(name) ? file.floats(name) : std::span<const float>(zeros));
      EXPECT_LT(off_shape, kToleranceMetres) << name;
      num_shapes += file.has(name);
    }
    if (file.has(part.name + ".triangles")) {
      const auto triangles = file.ints(part.name + ".triangles");
      ASSERT_EQ(triangles.size(), 3 * part.mesh.triangles.size());
      for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
        auto [a, b, c] = part.mesh.triangles[t];
        if (part.name.starts_with("ear")) std::swap(b, c);  // the reference winds ears inwards
        const auto ours = canonical(
            {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), static_cast<std::int32_t>(c)});
        ASSERT_EQ(ours, canonical({triangles[3 * t], triangles[3 * t + 1], triangles[3 * t + 2]})) << t;
      }
    }
  }
  EXPECT_GT(num_shapes, 150U);
  EXPECT_LT(worst_color, kToleranceColor);
  const head::HeadSkin& skin = reference_model().skin;
  EXPECT_EQ(as_ints(skin.mirror), as_ints(file.ints("skin.mirror")));
  EXPECT_EQ(as_ints(head::lip_region(skin)), as_ints(file.ints("skin.region.lips")));
  EXPECT_EQ(as_ints(head::upper_face_region(skin)), as_ints(file.ints("skin.region.upper_face")));
  EXPECT_EQ(as_ints(head::landmarks68(skin)), as_ints(file.ints("skin.landmarks68")));
}

TEST(HeadReference, SampleOfEveryPartAndShape) {
  compare_with(Reference(project_path("tests/data/face/head_sample.safetensors")));
}

TEST(HeadReference, EverythingIfTheFullReferenceIsThere) {
  const char* path = std::getenv("MIEN_HEAD_REFERENCE");
  if (path == nullptr) GTEST_SKIP() << "MIEN_HEAD_REFERENCE names no file";
  compare_with(Reference(path));
}

struct SpotValue {
  head::ChartPoint at;
  head::Vec3d base, skin;
};
const SpotValue kSpots[] = {
    {{0, 8}, {0, -4.15, 8.92}, {0, -4.15, 9.46951}},
    {{0, 10.5}, {0, -1.13666, 8.97934}, {0, -1.13666, 10.8596}},
    {{0.4, 12}, {3.60434, 2.78033, 7.92508}, {3.60508, 2.78033, 7.98311}},
    {{-0.6, 8.5}, {-4.52863, -2.86841, 6.56555}, {-4.4541, -2.86841, 6.49594}},
    {{1.2, 4.5}, {5.35269, -4.8752, 1.96101}, {5.30821, -4.8752, 1.94882}},
    {{3.0, 12}, {1.40733, 5.05718, -10.47277}, {1.40733, 5.05718, -10.47277}},
};

TEST(HeadReference, SpotValuesOfTheSurface) {
  for (const SpotValue& spot : kSpots) {
    EXPECT_LT(length(head::base_point(spot.at) - spot.base), 2e-5);
    EXPECT_LT(length(head::skin_point(spot.at) - spot.skin), 6e-5);
  }
  for (const auto& [x, y, azimuth, station] : {std::array{0.0, -4.15, 0.0, 8.0},
                                               {2.66, -4.15, 0.319446, 7.725314},
                                               {3.2, 3.9, 0.342897, 12.586578}}) {
    const auto at = head::find_in_front(x, y);
    EXPECT_NEAR(at.azimuth, azimuth, 1e-6);
    EXPECT_NEAR(at.station, station, 1e-6);
  }
}

TEST(HeadReference, SpotValuesOfTheShapes) {
  const auto& skin = reference_model().skin;
  const auto check = [](std::string_view shape, std::uint32_t vertex, head::Vec3d expected) {
    const Offsets& offsets = reference_model().parts.front().shapes[arkit_index(shape)];
    EXPECT_LT(length(offsets[vertex] - expected), 1.5e-4) << shape << " " << vertex;
  };
  check("jawOpen", skin.mouth.rings[head::kContactRing][36], {0, -3.0285, -1.7259});
  check("jawOpen", skin.mouth.rings[head::kContactRing][head::kLeftCorner], {-0.3, -1.0869, -0.743});
  check("eyeBlinkLeft", skin.eyes[0].rings[head::kLidEdgeRing][7], {0, -0.8172, 0.0985});
  check("jawOpen", 2171, {-0.2268, -1.4534, -1.3133});
  check("mouthSmileLeft", 3083, {0.2066, 0.2409, -0.0041});
  check("cheekPuff", 3075, {0.2814, 0.0017, 0.5669});
}

// Eye corners: 4 half ellipsoids of 73 vertices; lashes: 2 strips.
constexpr std::size_t kOurVertices = 4 * 73 + 2 * (2 * 73 + 36), kOurTriangles = 4 * 132 + 2 * (144 + 72);

TEST(HeadReference, NumbersOfVerticesAndTriangles) {
  std::size_t vertices = 0, triangles = 0;
  for (const auto& part : built_head().character.parts) {
    vertices += part.mesh.positions.size();
    triangles += part.mesh.triangles.size();
  }
  EXPECT_EQ(vertices, 17375U + kOurVertices);
  EXPECT_EQ(triangles, 33644U + kOurTriangles);
}

}  // namespace
}  // namespace mien
