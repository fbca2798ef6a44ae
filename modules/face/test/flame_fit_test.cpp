#include "mien/face/flame_fit.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>

#include "built_head.h"
#include "made_flame.h"
#include "mien/base/file.h"
#include "mien/base/random.h"
#include "mien/core/flame_parameters.h"
#include "mien/face/flame.h"
#include "mien/fit/coefficient_fit.h"
#include "mien/io/character_file.h"
#include "mien/io/index_list.h"
#include "mien/transfer/shape_transfer.h"
#include "test_paths.h"

namespace mien {
namespace {

using testing::Each;
using testing::Lt;

/// The head's skin, and a model in FLAME's form of its topology.
struct Made {
  const CharacterPart& skin = test::built_head().character.parts.front();
  FlameModel model = made_flame(skin.mesh, skin.shapes);
  FlamePoser poser{model};
  [[nodiscard]] std::size_t num_expressions() const {
    return static_cast<std::size_t>(model.num_shapes) - kNumFlameShape;
  }
  [[nodiscard]] FlameFitOptions options() const {
    return {.num_expressions = static_cast<std::int64_t>(num_expressions()), .num_threads = 2};
  }
};
const Made& made() {
  static const Made all;
  return all;
}

Motion parameters(std::int64_t num_frames) {
  const std::size_t count = made().num_expressions();
  Motion motion{MotionSpace::flame, flame_channels(0, count), 25, {}};
  Rng rng(3);
  for (std::int64_t n = 0; n < num_frames; ++n) {
    for (std::size_t e = 0; e < count; ++e) motion.values.push_back(static_cast<float>(rng.normal(0, 1)));
    for (const double most : {0.4, 0.1, 0.1})
      motion.values.push_back(static_cast<float>(rng.uniform(-0.2 * most, most)));
  }
  return motion;
}

double most(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }
double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

TEST(FlameFit, FindsTheParametersThatMadeTheVertices) {
  const Motion truth = parameters(4);
  const auto vertices = flame_vertices(made().poser, truth, 2);
  ASSERT_TRUE(vertices) << vertices.error().message();
  Progress progress;
  FlameFitOptions options = made().options();
  options.expression_cost = 1e-8;  // next to nothing: the vertices decide all
  const std::map<std::string, std::vector<std::uint32_t>> regions = {{"first", {0, 1, 2}}};
  const auto fit = fit_flame(made().model, *vertices, {}, regions, options, progress);
  ASSERT_TRUE(fit) << fit.error().message();
  EXPECT_EQ(fit->parameters.channels, truth.channels);
  ASSERT_EQ(fit->parameters.values.size(), truth.values.size());
  for (std::size_t i = 0; i < truth.values.size(); ++i)
    EXPECT_NEAR(fit->parameters.values[i], truth.values[i], 2e-4)
        << truth.channels[i % truth.channels.size()];
  EXPECT_THAT(fit->residual, Each(Lt(1e-7)));  // float32 positions of 0.1 m
  EXPECT_EQ(fit->region_residual.at("first").size(), 4u);
  EXPECT_LE(fit->num_iterations, 12) << "the derivatives are those of the model";

  options.num_threads = 1;
  const auto again = fit_flame(made().model, *vertices, {}, regions, options, progress);
  EXPECT_EQ(again->parameters.values, fit->parameters.values);
  // Some of the vertices are enough, and a frame does not depend on the others.
  std::vector<std::uint32_t> some;
  for (std::uint32_t v = 0; v < made().skin.mesh.positions.size(); v += 3) some.push_back(v);
  Motion last = *vertices;
  last.values.assign(vertices->frame(3).begin(), vertices->frame(3).end());
  const auto part = fit_flame(made().model, last, some, {}, options, progress);
  ASSERT_TRUE(part) << part.error().message();
  const auto width = truth.channels.size();
  for (std::size_t c = 0; c < width; ++c)
    EXPECT_NEAR(part->parameters.values[c], truth.values[3 * width + c], 2e-3);
}

TEST(FlameVertices, ParametersThatTheModelLacksMayOnlyBeZero) {
  Motion motion{MotionSpace::flame, flame_channels(300, 100), 25, std::vector<float>(403)};
  motion.values[402] = 0.1f;
  EXPECT_TRUE(flame_vertices(made().poser, motion));
  motion.values[399] = 0.1f;
  const auto refused = flame_vertices(made().poser, motion);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::incompatible);
}

TEST(FlameFit, TheFaceAtRestHasNoParameters) {
  const auto rest = flame_vertices(made().poser, Motion{MotionSpace::flame, {"jaw_x"}, 25, {0}});
  ASSERT_TRUE(rest);
  Progress progress;
  const auto fit = fit_flame(made().model, *rest, {}, {}, made().options(), progress);
  ASSERT_TRUE(fit) << fit.error().message();
  for (const float v : fit->parameters.values) EXPECT_NEAR(v, 0, 1e-4);
  Motion none = *rest;
  none.values.clear();
  const auto empty = fit_flame(made().model, none, {}, {}, made().options(), progress);
  ASSERT_TRUE(empty);
  EXPECT_EQ(empty->parameters.num_frames(), 0);
}

// A model whose jaw moves nothing leaves the jaw where it is.
TEST(FlameFit, AJawThatMovesNothingStays) {
  FlameModel stiff = made().model;
  for (std::size_t v = 0; v < static_cast<std::size_t>(stiff.num_vertices); ++v) {
    stiff.weights[v * kNumFlameJoints + 1] = 1;
    stiff.weights[v * kNumFlameJoints + 2] = 0;
  }
  std::fill(stiff.pose_shapes.begin(), stiff.pose_shapes.end(), 0.0f);
  const auto vertices = flame_vertices(FlamePoser(stiff), parameters(1));
  ASSERT_TRUE(vertices);
  Progress progress;
  const auto fit = fit_flame(stiff, *vertices, {}, {}, made().options(), progress);
  ASSERT_TRUE(fit);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(fit->parameters.values[made().num_expressions() + k], 0);
  EXPECT_LT(fit->residual[0], 1e-4);
}

TEST(FlameFit, RefusesWhatDoesNotFit) {
  Progress progress;
  const auto rest = flame_vertices(made().poser, Motion{MotionSpace::flame, {"jaw_x"}, 25, {0}});
  const auto code = [&](const Motion& motion, FlameFitOptions options) {
    return fit_flame(made().model, motion, {}, {}, options, progress).error().code;
  };
  EXPECT_EQ(code(vertex_motion({"two", 2}, 25, std::vector<float>(6)), made().options()), Errc::incompatible);
  EXPECT_EQ(code(parameters(1), made().options()), Errc::incompatible);
  FlameFitOptions many = made().options();
  many.num_expressions += 1;
  EXPECT_EQ(code(*rest, many), Errc::incompatible);
  Motion broken = *rest;
  broken.values[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(code(broken, made().options()), Errc::input);
  Progress stopped;
  stopped.cancel();
  EXPECT_EQ(fit_flame(made().model, *rest, {}, {}, made().options(), stopped).error().code, Errc::cancelled);
}

/// A second of ARKit curves in which jaw, mouth, lids and brows move at rates of their own.
Motion arkit_curves(const std::vector<Blendshape>& shapes) {
  Motion motion{MotionSpace::arkit, {}, 60, {}};
  for (const auto& shape : shapes) motion.channels.push_back(shape.name);
  for (int n = 0; n < 60; ++n)
    for (std::size_t c = 0; c < shapes.size(); ++c) {
      const double phase = 0.7 * static_cast<double>(c), rate = 0.08 + 0.004 * static_cast<double>(c % 9);
      const double strength = shapes[c].name == "jawOpen" ? 0.7 : shapes[c].name == "jawForward" ? 0.1 : 0.3;
      motion.values.push_back(static_cast<float>(strength * (0.5 - 0.5 * std::cos(rate * n + phase))));
    }
  return motion;
}

Motion performed(const CharacterPart& face, const std::vector<Blendshape>& shapes, const Motion& curves) {
  Motion motion = vertex_motion({"made", static_cast<std::int64_t>(face.mesh.positions.size())}, curves.fps);
  std::vector<Vec3> frame(face.mesh.positions.size());
  for (std::int64_t n = 0; n < curves.num_frames(); ++n) {
    evaluate_blendshapes(face.mesh.positions, shapes, curves.frame(n), frame);
    for (const Vec3& p : frame) motion.values.insert(motion.values.end(), {p.x, p.y, p.z});
  }
  return motion;
}

std::vector<Blendshape> without_gaze_and_tongue(std::span<const Blendshape> shapes) {
  std::vector<Blendshape> kept;
  for (const Blendshape& shape : shapes)
    if (!shape.vertices.empty() && !shape.name.starts_with("eyeLook") && shape.name != "tongueOut")
      kept.push_back(shape);
  return kept;
}

/// What is lost from ARKit to FLAME and back, in metres; it is printed too.
struct RoundTrip {
  double to_flame = 0, to_arkit = 0;     // mean over frames of what each fit leaves over
  double whole = 0, farthest = 0;        // vertices at the end against the start
  double curves = 0, largest_curve = 0;  // mean and largest difference of the curves
  int num_steps = 0;
};

RoundTrip round_trip(const FlameModel& model, const CharacterPart& face,
                     const std::vector<Blendshape>& shapes,
                     const std::map<std::string, std::vector<std::uint32_t>>& regions) {
  const Motion curves = arkit_curves(shapes), there = performed(face, shapes, curves);
  Progress progress;
  const FlameFitOptions options = {
      .num_expressions = model.num_shapes - static_cast<std::int64_t>(kNumFlameShape), .num_threads = 2};
  const auto flame = fit_flame(model, there, {}, regions, options, progress);
  EXPECT_TRUE(flame) << flame.error().message();
  const auto vertices = flame_vertices(FlamePoser(model), flame->parameters, 2);
  EXPECT_TRUE(vertices) << vertices.error().message();
  const auto back =
      fit_coefficients(face.mesh.positions, shapes, *vertices, regions, {.num_threads = 2}, progress);
  EXPECT_TRUE(back) << back.error().message();
  RoundTrip trip{.to_flame = mean(flame->residual), .to_arkit = mean(back->residual)};
  trip.num_steps = flame->num_iterations;
  const auto count = static_cast<double>(curves.values.size());
  for (std::size_t i = 0; i < curves.values.size(); ++i) {
    const double miss =
        std::abs(static_cast<double>(back->coefficients.values[i]) - static_cast<double>(curves.values[i]));
    trip.curves += miss / count;
    trip.largest_curve = std::max(trip.largest_curve, miss);
  }
  const Motion again = performed(face, shapes, back->coefficients);
  double squares = 0;
  for (std::size_t i = 0; i < again.values.size(); i += 3) {
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double miss = static_cast<double>(again.values[i + k]) - static_cast<double>(there.values[i + k]);
      square += miss * miss;
    }
    squares += square;
    trip.farthest = std::max(trip.farthest, std::sqrt(square));
  }
  trip.whole = std::sqrt(squares / (static_cast<double>(again.values.size()) / 3));
  std::printf("ARKit to FLAME: mean %.2f mm, worst frame %.2f mm, %d steps\n", 1000 * trip.to_flame,
              1000 * most(flame->residual), trip.num_steps);
  std::printf("FLAME to ARKit: mean %.2f mm, worst frame %.2f mm\n", 1000 * trip.to_arkit,
              1000 * most(back->residual));
  for (const auto& [name, there_mm] : flame->region_residual)
    std::printf("  %s: %.2f and %.2f mm\n", name.c_str(), 1000 * mean(there_mm),
                1000 * mean(back->region_residual.at(name)));
  std::printf("there and back: %.2f mm, farthest vertex %.2f mm, curves %.3f mean, %.2f most\n",
              1000 * trip.whole, 1000 * trip.farthest, trip.curves, trip.largest_curve);
  return trip;
}

// The figures are those of docs/probtalk3d.md.
TEST(FlameFit, ArkitCurvesComeBackFromFlame) {
  const CharacterPart& skin = made().skin;
  const auto trip = round_trip(made().model, skin, without_gaze_and_tongue(skin.shapes),
                               test::built_head().character.regions);
  EXPECT_LT(trip.to_flame, 0.8e-3);
  EXPECT_LT(trip.to_arkit, 0.8e-3);
  EXPECT_LT(trip.whole, 0.3e-3);
  EXPECT_LT(trip.curves, 0.07) << "shapes that look alike take each other's part";
  EXPECT_LE(trip.num_steps, 12);
}

// The part of the first vertices alone, with their triangles and shapes.
CharacterPart first_vertices(CharacterPart part, std::uint32_t count) {
  part.mesh.positions.resize(count);
  part.mesh.normals.clear(), part.mesh.colors.clear();
  std::erase_if(part.mesh.triangles, [&](const auto& t) { return std::max({t[0], t[1], t[2]}) >= count; });
  for (Blendshape& shape : part.shapes) {
    const auto kept =
        std::lower_bound(shape.vertices.begin(), shape.vertices.end(), count) - shape.vertices.begin();
    shape.vertices.resize(static_cast<std::size_t>(kept));
    shape.offsets.resize(static_cast<std::size_t>(kept));
    shape.normal_offsets.clear();
  }
  return part;
}

// A rig by transfer from Mien's head on a face whose model was made of other people's shapes.
TEST(FlameFit, ArkitCurvesComeBackThroughATransferredRig) {
  const auto path = shared_path("faces/makehuman_head.safetensors");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const auto face = load_character(path);
  ASSERT_TRUE(face) << face.error().message();
  const CharacterPart theirs = first_vertices(face->parts.front(), 4439);  // no eyes, teeth and tongue
  const std::size_t count = theirs.mesh.positions.size();
  const auto places = read_file(project_path("tests/data/face/makehuman_landmarks68.txt"));
  ASSERT_TRUE(places) << places.error().message();
  const auto landmarks = read_index_list(as_text(*places), count);
  ASSERT_TRUE(landmarks) << landmarks.error().message();
  const auto& own = test::built_head().character.regions.at("landmarks68");
  std::vector<Marker> markers;
  for (std::size_t i = 0; i < own.size(); ++i) markers.push_back({own[i], landmarks->at(i)});
  Progress progress;
  const auto rig = transfer_shapes({&made().skin.mesh}, made().skin.shapes, {&theirs.mesh}, markers,
                                   {.registration = {}, .num_threads = 2}, progress);
  ASSERT_TRUE(rig) << rig.error().message();
  const auto trip =
      round_trip(made_flame(theirs.mesh, theirs.shapes), theirs, without_gaze_and_tongue(rig->shapes), {});
  EXPECT_LT(trip.to_flame, 1.6e-3);
  EXPECT_LT(trip.to_arkit, 1.3e-3);
  EXPECT_LT(trip.whole, 0.9e-3);
}

}  // namespace
}  // namespace mien
