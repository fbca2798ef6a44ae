// Errors of sequences against what the authors' evaluation programs computed.
#include <algorithm>
#include <map>

#include "closeness.h"
#include "fixture.h"
#include "mien/metrics/control_error.h"
#include "mien/metrics/surface_distance.h"
#include "mien/metrics/take_error.h"
#include "mien/metrics/vertex_error.h"
#include "mien/metrics/vertex_regions.h"
#include "mien/metrics/vertex_travel.h"

namespace mien::parity {
namespace {

using Values = std::vector<double>;

// The part of a name behind "gt.", "pred." or "div.", of all tensors that start so, in the order of the file.
std::vector<std::string> names_of(const Fixture& fixture, const std::string& prefix) {
  std::vector<std::string> names;
  for (const auto& tensor : fixture.file().tensors())
    if (tensor.name.starts_with(prefix)) names.push_back(tensor.name.substr(prefix.size()));
  return names;
}

Motion vertices(const Fixture& fixture, const std::string& name) {
  const Tensor values = fixture.tensor(name);
  return vertex_motion({"recorded", values.shape().back() / 3}, 25,
                       {values.values().begin(), values.values().end()});
}

Motion controls(const Fixture& fixture, const std::string& name) {
  const Tensor values = fixture.tensor(name);
  Motion motion{MotionSpace::rig, {}, 30, {values.values().begin(), values.values().end()}};
  for (std::int64_t c = 0; c < values.shape().back(); ++c) motion.channels.push_back(std::to_string(c));
  return motion;
}

std::vector<std::uint32_t> indices(const Fixture& fixture, const std::string& name) {
  const auto values = fixture.integers(name);
  return {values.begin(), values.end()};
}

// Weights as the data set's text file, one a line.
std::string text_of(const Values& weights) {
  std::string text;
  for (const double w : weights) text += nlohmann::json(w).dump() + "\n";
  return text;
}

VertexRegions regions_of(const Fixture& fixture) {
  VertexRegions regions{indices(fixture, "region.mouth"), indices(fixture, "region.upper")};
  if (!fixture.has("mouth_weights")) return regions;
  const auto mouth = fixture.doubles("mouth_weights"), forehead = fixture.doubles("forehead_weights");
  const auto count = static_cast<std::int64_t>(mouth.size());
  EXPECT_EQ(read_region(text_of(mouth), count, kMouthWeightAbove).value(), regions.mouth);
  EXPECT_EQ(read_region(text_of(forehead), count, kUpperWeightAbove).value(), regions.upper);
  return regions;
}

TEST(MetricsParity, VertexErrors) {
  for_each_case("facediffuser", "metrics.vertex_", ".safetensors", [](const std::string& name) {
    const Fixture fixture("facediffuser", "metrics.vertex_" + name + ".safetensors");
    VertexErrors errors(regions_of(fixture));
    Values per_sequence;
    for (const auto& sequence : names_of(fixture, "gt.")) {
      const auto neutral = fixture.tensor("template." + sequence.substr(0, sequence.rfind('_')));
      const auto added = errors.add(sequence, vertices(fixture, "gt." + sequence),
                                    vertices(fixture, "pred." + sequence), neutral.values());
      ASSERT_TRUE(added) << added.error().message();
      per_sequence.push_back(errors.sequences().back().fdd);
    }
    MIEN_EXPECT_CLOSE(Values{errors.mve()}, fixture.doubles("expected.MVE"), "metrics.error");
    MIEN_EXPECT_CLOSE(Values{errors.lve()}, fixture.doubles("expected.LVE"), "metrics.error");
    MIEN_EXPECT_CLOSE(Values{errors.fdd()}, fixture.doubles("expected.FDD"), "metrics.error");
    MIEN_EXPECT_CLOSE(Values{errors.absolute_fdd()}, fixture.doubles("expected.ABS_FDD"), "metrics.error");
    MIEN_EXPECT_CLOSE(per_sequence, fixture.doubles("expected.fdd_per_sequence"), "metrics.error");
    EXPECT_EQ(static_cast<double>(errors.num_frames()), fixture.doubles("expected.frames")[0]);
  });
}

TEST(MetricsParity, Diversity) {
  for_each_case("facediffuser", "metrics.vertex_", ".safetensors", [](const std::string& name) {
    const Fixture fixture("facediffuser", "metrics.vertex_" + name + ".safetensors");
    std::map<std::string, std::vector<Motion>> takes;  // by sequence
    for (const auto& take : names_of(fixture, "div."))
      takes[take.substr(0, take.find("_condition_"))].push_back(vertices(fixture, "div." + take));
    ASSERT_FALSE(takes.empty());
    double sum = 0, count = 0;
    for (const auto& [sequence, motions] : takes)
      if (motions.size() > 1) sum += take_diversity(motions), ++count;
    MIEN_EXPECT_CLOSE(Values{sum / count}, fixture.doubles("expected.Diversity"), "metrics.error");
  });
}

TEST(MetricsParity, ControlErrors) {
  std::size_t replayed = 0;
  for_each_case("facediffuser", "metrics.", ".safetensors", [&](const std::string& name) {
    if (name.starts_with("vertex_")) return;
    const Fixture fixture("facediffuser", "metrics." + name + ".safetensors");
    const auto sequences = names_of(fixture, "gt.");
    ASSERT_FALSE(sequences.empty());
    const auto regions = control_regions(controls(fixture, "gt." + sequences[0]).num_channels());
    ASSERT_TRUE(regions) << "no regions are known for so many channels";
    ControlErrors errors(*regions);
    for (const auto& sequence : sequences) {
      const auto added =
          errors.add(sequence, controls(fixture, "gt." + sequence), controls(fixture, "pred." + sequence));
      ASSERT_TRUE(added) << added.error().message();
    }
    MIEN_EXPECT_CLOSE(Values{errors.mce()}, fixture.doubles("expected.MCE"), "metrics.error");
    MIEN_EXPECT_CLOSE(Values{errors.lce()}, fixture.doubles("expected.LCE"), "metrics.error");
    MIEN_EXPECT_CLOSE(Values{errors.fdd()}, fixture.doubles("expected.C_FDD"), "metrics.energy");
    MIEN_EXPECT_CLOSE(Values{errors.absolute_fdd()}, fixture.doubles("expected.ABS_C_FDD"), "metrics.energy");
    EXPECT_EQ(static_cast<double>(errors.num_frames()), fixture.doubles("expected.frames")[0]);
    ++replayed;
  });
}

// Sample i of a tensor [S, N, V, 3].
Motion sample(const Fixture& fixture, const std::string& name, std::int64_t i) {
  const auto all = fixture.file().as<float>(name).value();
  const Shape& shape = fixture.file().find(name)->shape;
  const auto count = static_cast<std::size_t>(shape.at(1) * shape.at(2) * shape.at(3));
  const auto own = all.subspan(static_cast<std::size_t>(i) * count, count);
  return vertex_motion({"recorded", shape.at(2)}, 25, {own.begin(), own.end()});
}

TEST(MetricsParity, HeatMaps) {
  const std::string mean = "out.heatmap_mean_seq", deviation = "out.heatmap_std_seq";
  // One file, metrics.safetensors: a case has a name.
  for_each_case("probtalk3d", "metric", ".safetensors", [&](const std::string& name) {
    const Fixture fixture("probtalk3d", "metric" + name + ".safetensors");
    const auto maps = names_of(fixture, mean);  // "1_sample0": of a sequence and one of its samples
    ASSERT_FALSE(maps.empty());
    for (const auto& map : maps) {
      const auto cut = map.find("_sample");
      ASSERT_NE(cut, std::string::npos) << map;
      const std::string samples = "in.seq" + map.substr(0, cut) + ".samples";
      const auto travel = vertex_travel(sample(fixture, samples, std::stoll(map.substr(cut + 7))));
      ASSERT_TRUE(travel) << travel.error().message();
      const auto close = [&](const std::vector<float>& got, const std::string& want) {
        const Tensor recorded = fixture.tensor(want);
        MIEN_EXPECT_CLOSE(Values(got.begin(), got.end()),
                          Values(recorded.values().begin(), recorded.values().end()), "metrics.heat");
      };
      close(travel->mean, mean + map);
      close(travel->deviation, deviation + map);
    }
  });
}

TEST(MetricsParity, SurfaceDistance) {
  for_each_case("facexhubert", "metric.", ".safetensors", [](const std::string& name) {
    const Fixture fixture("facexhubert", "metric." + name + ".safetensors");
    const auto sequence = [&](const std::string& which) {
      const Tensor values = fixture.tensor(which);
      return vertex_motion({"recorded", fixture.file().find(which)->shape[1]}, 25,
                           {values.values().begin(), values.values().end()});
    };
    const Motion truth = sequence("gt"), predicted = sequence("pred");
    std::vector<TriangleTree::Triangle> triangles;
    const auto faces = indices(fixture, "faces");
    for (std::size_t i = 0; i + 2 < faces.size(); i += 3)
      triangles.push_back({faces[i], faces[i + 1], faces[i + 2]});
    const auto mean = surface_distance(truth, predicted, triangles);
    ASSERT_TRUE(mean) << mean.error().message();
    MIEN_EXPECT_CLOSE(Values{*mean}, fixture.doubles("expected.mean_face_vertex_error"), "metrics.error");

    Values distances;
    std::vector<Vec3> points(static_cast<std::size_t>(truth.topology.num_vertices));
    for (std::int64_t n = 0; n < std::min(truth.num_frames(), predicted.num_frames()); ++n) {
      copy_positions(truth, n, points);
      const TriangleTree tree(points, triangles);
      copy_positions(predicted, n, points);
      for (const Vec3& point : points) distances.push_back(tree.distance(point));
    }
    MIEN_EXPECT_CLOSE(distances, fixture.doubles("expected.per_vertex"), "metrics.distance");
  });
}

TEST(MetricsParity, ErrorsOfTakes) {
  for_each_case("probtalk3d", "metric", ".safetensors", [](const std::string& name) {
    const Fixture fixture("probtalk3d", "metric" + name + ".safetensors");
    const auto mouth = indices(fixture, "in.mouth_map"), upper = indices(fixture, "in.upper_map");
    const Tensor neutral = fixture.tensor("in.template");
    const auto number = [&](const std::string& value) { return double{fixture.tensor(value).values()[0]}; };
    VertexErrors first_takes({mouth, upper});
    TakeErrors errors(mouth);
    for (int s = 0; fixture.has("in.seq" + std::to_string(s) + ".gt"); ++s) {
      const std::string sequence = "seq" + std::to_string(s), in = "in." + sequence, mid = "mid." + sequence;
      SCOPED_TRACE(sequence);
      const Tensor recorded = fixture.tensor(in + ".gt");
      const Motion truth = vertex_motion({"recorded", recorded.shape().at(1)}, 25,
                                         {recorded.values().begin(), recorded.values().end()});
      std::vector<Motion> takes;
      for (std::int64_t i = 0; i < fixture.file().find(in + ".samples")->shape.at(0); ++i)
        takes.push_back(sample(fixture, in + ".samples", i));
      const auto order = fixture.integers(in + ".shuffle_order");
      const std::vector<std::size_t> shuffled(order.begin(), order.end());
      ASSERT_TRUE(errors.add(sequence, truth, takes, shuffled));
      ASSERT_TRUE(first_takes.add(sequence, truth, takes.front(), neutral.values()));
      MIEN_EXPECT_CLOSE(Values{errors.sequences().back().diversity}, fixture.doubles(mid + ".diversity"),
                        "metrics.error");
      MIEN_EXPECT_CLOSE(Values{first_takes.sequences().back().fdd},
                        Values{number(mid + ".upper_std_gt") - number(mid + ".upper_std_pred")},
                        "metrics.take");
    }
    ASSERT_FALSE(errors.sequences().empty());
    MIEN_EXPECT_CLOSE(Values{first_takes.mve()}, fixture.doubles("out.MVE"), "metrics.take");
    MIEN_EXPECT_CLOSE(Values{first_takes.lve()}, fixture.doubles("out.LVE"), "metrics.take");
    MIEN_EXPECT_CLOSE(Values{first_takes.fdd()}, fixture.doubles("out.FDD"), "metrics.take");
    MIEN_EXPECT_CLOSE(Values{errors.mee()}, fixture.doubles("out.MEE"), "metrics.take");
    MIEN_EXPECT_CLOSE(Values{errors.ce()}, fixture.doubles("out.CE"), "metrics.take");
    MIEN_EXPECT_CLOSE(Values{errors.diversity()}, fixture.doubles("out.Diversity"), "metrics.take");
  });
}

}  // namespace
}  // namespace mien::parity
