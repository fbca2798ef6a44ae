#include "mien/transfer/shape_transfer.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "mien/io/character_file.h"
#include "mien/transfer/shape_comparison.h"
#include "sheet.h"
#include "test_paths.h"

namespace mien {
namespace {

using testing::HasSubstr;

const std::vector<Marker> kMarkers = {{0, 0}, {10, 16}, {110, 238}, {120, 254}, {60, 127}};

Point3 raise(const Point3& p) {
  return {0, 0.05, 0.2 * std::exp(-6 * ((p[0] - 0.2) * (p[0] - 0.2) + p[1] * p[1]))};
}

Blendshape shape_of(const Surface& surface, const std::string& name, double size) {
  Blendshape shape{name, {}, {}, {}};
  for (std::uint32_t v = 0; v < surface.points.size() && size != 0; ++v) {
    const Point3 d = raise(surface.points[v]);
    shape.vertices.push_back(v);
    shape.offsets.push_back(
        {static_cast<float>(size * d[0]), static_cast<float>(size * d[1]), static_cast<float>(size * d[2])});
  }
  return shape;
}

TEST(ShapeTransfer, MakesTheShapesOfTheSameSurfaceOnAnotherMesh) {
  const Mesh source = mesh_of(sheet(11, 11)), target = mesh_of(sheet(17, 15));
  const std::vector<Blendshape> shapes = {shape_of(sheet(11, 11), "raise", 1),
                                          shape_of(sheet(11, 11), "none", 0),
                                          shape_of(sheet(11, 11), "half", 0.5)};
  Progress progress;
  const auto result = transfer_shapes({&source}, shapes, {&target}, kMarkers, {}, progress);
  ASSERT_TRUE(result.has_value()) << result.error().message();
  EXPECT_THAT(result.warnings.front(), HasSubstr("do not move the source: none"));
  ASSERT_EQ(result->shapes.size(), 2u);
  EXPECT_EQ(result->shapes[1].name, "half");
  ASSERT_EQ(result->report.shapes.size(), 3u);
  EXPECT_EQ(result->report.num_paired, target.triangles.size());
  std::vector<Vec3> moved(target.positions.size());
  for (std::size_t m = 0; m < result->shapes[0].vertices.size(); ++m)
    moved[result->shapes[0].vertices[m]] = result->shapes[0].offsets[m];
  double worst = 0;
  for (std::size_t v = 0; v < moved.size(); ++v) {
    const Point3 wanted = raise(sheet(17, 15).points[v]);
    worst = std::max({worst, std::abs(moved[v].x - wanted[0]), std::abs(moved[v].y - wanted[1]),
                      std::abs(moved[v].z - wanted[2])});
  }
  EXPECT_LT(worst, 0.03);  // of 0.2; the source samples its bump with 11 x 11 vertices

  ShapeTransferOptions threads;
  threads.num_threads = 3;
  const auto again = transfer_shapes({&source}, shapes, {&target}, kMarkers, threads, progress);
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->shapes[0].offsets, result->shapes[0].offsets);
}

// A target of twice the size that faces another way: its shapes are turned and scaled with it.
TEST(ShapeTransfer, TurnsAndScalesShapesWithTheTarget) {
  const auto turned = [](const Point3& p) { return Point3{-2 * p[1], 2 * p[0], 2 * p[2]}; };
  Surface other = sheet(17, 15);
  for (Point3& p : other.points) p = turned(p);
  const Mesh source = mesh_of(sheet(11, 11)), target = mesh_of(other);
  const std::vector<Blendshape> shapes = {shape_of(sheet(11, 11), "raise", 1)};
  Progress progress;
  const auto result = transfer_shapes({&source}, shapes, {&target}, kMarkers, {}, progress);
  ASSERT_TRUE(result.has_value()) << result.error().message();
  EXPECT_NEAR(result->report.similarity.scale, 2, 1e-3);
  const Blendshape& made = result->shapes.at(0);
  double worst = 0;
  for (std::size_t m = 0; m < made.vertices.size(); ++m) {
    const Point3 wanted = turned(raise(sheet(17, 15).points[made.vertices[m]]));
    const Vec3& o = made.offsets[m];
    worst =
        std::max({worst, std::abs(o.x - wanted[0]), std::abs(o.y - wanted[1]), std::abs(o.z - wanted[2])});
  }
  EXPECT_LT(worst, 0.06);  // of 0.4, twice what the same surface allows
}

TEST(ShapeTransfer, PiecesThatTouchStayTogether) {
  const Mesh source = mesh_of(sheet(11, 11)), target = mesh_of(cut_along(sheet(17, 15), 17, 6));
  const std::vector<Blendshape> shapes = {shape_of(sheet(11, 11), "raise", 1)};
  Progress progress;
  const auto result = transfer_shapes({&source}, shapes, {&target}, kMarkers, {}, progress);
  ASSERT_TRUE(result.has_value()) << result.error().message();
  EXPECT_EQ(result->report.num_ties, 15u);
  std::vector<Point3> moved(target.positions.size());
  for (std::size_t m = 0; m < result->shapes[0].vertices.size(); ++m) {
    const Vec3& o = result->shapes[0].offsets[m];
    moved[result->shapes[0].vertices[m]] = {o.x, o.y, o.z};
  }
  for (std::size_t j = 0; j < 15; ++j) {
    const Point3 &left = moved[17 * j + 6], &right = moved[255 + j];
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(left[axis], right[axis], 2e-5) << j;  // of 0.2
  }
}

TEST(ShapeTransfer, ExcludedPartsDoNotMove) {
  const Mesh source = mesh_of(sheet(11, 11)), target = mesh_of(sheet(17, 15));
  std::vector<bool> excluded(target.positions.size());
  for (std::size_t v = 0; v < 34; ++v) excluded[v] = true;  // two rows, with two markers
  Progress progress;
  const auto error = transfer_shapes({&source}, {}, {&target, excluded}, kMarkers, {}, progress);
  ASSERT_FALSE(error.has_value());
  EXPECT_THAT(error.error().message(), HasSubstr("there are 3, at least 4"));
  auto markers = kMarkers;
  markers.push_back({66, 133});
  const std::vector<Blendshape> shapes = {shape_of(sheet(11, 11), "raise", 1)};
  const auto result = transfer_shapes({&source}, shapes, {&target, excluded}, markers, {}, progress);
  ASSERT_TRUE(result.has_value()) << result.error().message();
  EXPECT_THAT(result.warnings.front(), HasSubstr("2 of 6 markers"));
  EXPECT_GE(result->shapes[0].vertices.front(), 34u);
  const TransferMesh nothing = {&target, std::vector<bool>(target.positions.size(), true)};
  EXPECT_EQ(transfer_shapes({&source}, {}, nothing, markers, {}, progress).error().code, Errc::input);
}

TEST(ShapeTransfer, NamesAMarkerThatIsNotThere) {
  const Mesh source = mesh_of(sheet(11, 11)), target = mesh_of(sheet(17, 15));
  const std::vector<Blendshape> shapes = {shape_of(sheet(11, 11), "raise", 1)};
  auto markers = kMarkers;
  markers.push_back({1, 255});
  Progress progress;
  const auto result = transfer_shapes({&source}, shapes, {&target}, markers, {}, progress);
  ASSERT_FALSE(result.has_value());
  EXPECT_THAT(result.error().message(), HasSubstr("marker 6: its target vertex 255 does not exist"));
}

TEST(ShapeTransfer, StopsWhenInterrupted) {
  const Mesh source = mesh_of(sheet(11, 11)), target = mesh_of(sheet(17, 15));
  Progress progress;
  progress.cancel();
  EXPECT_EQ(transfer_shapes({&source}, {}, {&target}, kMarkers, {}, progress).error().code, Errc::cancelled);
}

TEST(ShapeComparison, MeasuresWhatCounts) {
  const std::vector<Blendshape> ours = {{"a", {0, 2}, {{0.001f, 0, 0}, {0, 0, 0.009f}}, {}},
                                        {"b", {}, {}, {}}},
                                theirs = {{"c", {0}, {{1, 0, 0}}, {}},
                                          {"a", {0, 1}, {{0.003f, 0, 0}, {0, 0.004f, 0}}, {}}};
  const auto found = compare_shapes(ours, theirs, {false, false, true});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].name, "a");
  EXPECT_NEAR(found[0].mean_mm, 3, 1e-6);  // 2 and 4 mm; the third vertex does not count
  EXPECT_NEAR(found[0].max_mm, 4, 1e-6);
  EXPECT_NEAR(found[0].max_percent(), 100, 1e-4);
  EXPECT_NEAR(found[0].cosine, 3.0 / 5, 1e-6);
  const auto same = compare_shapes(ours, ours, {false, false, false});
  ASSERT_EQ(same.size(), 2u);
  EXPECT_EQ(same[0].max_mm, 0);
  EXPECT_NEAR(same[0].cosine, 1, 1e-6);
  EXPECT_EQ(same[1].mean_percent(), 0);
}

// Shapes that artists made for one face, brought to another and compared with the other artists' shapes.
TEST(ShapeTransfer, ComesCloseToTheArtistsOfAnotherRealFace) {
  const auto faces = shared_path("faces");
  const auto from = load_character(faces / "arkit_reference.safetensors"),
             to = load_character(faces / "ict_facekit.safetensors");
  if (!from || !to) GTEST_SKIP() << "no arkit_reference and ict_facekit in " << faces;
  const CharacterPart &source = from->parts[0], &target = to->parts[0];
  std::vector<Marker> markers;
  for (std::size_t i = 0; i < 68; ++i)
    markers.push_back({from->regions.at("landmarks68")[i], to->regions.at("landmarks68")[i]});
  std::vector<bool> excluded(target.mesh.positions.size());
  for (std::size_t v = 9409; v < excluded.size(); ++v) excluded[v] = true;  // all but the face
  Progress progress;
  const auto result =
      transfer_shapes({&source.mesh}, source.shapes, {&target.mesh, excluded}, markers, {}, progress);
  ASSERT_TRUE(result.has_value()) << result.error().message();
  EXPECT_NEAR(result->report.similarity.scale, 0.98, 0.01);
  std::vector<double> cosines;
  for (const ShapeComparison& c : compare_shapes(result->shapes, target.shapes, excluded))
    cosines.push_back(c.cosine);
  ASSERT_EQ(cosines.size(), 51u);
  std::sort(cosines.begin(), cosines.end());
  EXPECT_GT(cosines[25], 0.84);  // 0.858 measured
  EXPECT_GT(cosines.front(), 0.6);
}

}  // namespace
}  // namespace mien
