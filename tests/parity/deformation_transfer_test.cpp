// Deformation transfer (SAiD specification, section 10.3): recorded problems with their solutions.
#include "mien/transfer/deformation_transfer.h"

#include <gtest/gtest.h>

#include "closeness.h"
#include "fixture.h"

namespace mien::parity {
namespace {

std::vector<Point3> points(const Fixture& recorded, const std::string& name) {
  const auto values = recorded.doubles(name);
  std::vector<Point3> points;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3)
    points.push_back({values[i], values[i + 1], values[i + 2]});
  return points;
}

std::vector<std::uint32_t> indices(const Fixture& recorded, const std::string& name) {
  std::vector<std::uint32_t> numbers;
  if (const auto* tensor = recorded.file().find(name); tensor && tensor->dtype == Dtype::i32) {
    const auto stored = recorded.file().as<std::int32_t>(name);
    for (const auto v : *stored) numbers.push_back(static_cast<std::uint32_t>(v));
  } else {
    for (const auto v : recorded.integers(name)) numbers.push_back(static_cast<std::uint32_t>(v));
  }
  return numbers;
}

void expect_recorded_solution(const Fixture& recorded) {
  Surface source{points(recorded, "source_neutral"), {}}, target{points(recorded, "target_neutral"), {}};
  const auto corners = indices(recorded, "faces");
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    source.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  target.triangles = source.triangles;
  const auto from = indices(recorded, "pairs_source"), to = indices(recorded, "pairs_target");
  std::vector<TrianglePair> pairs;
  for (std::size_t i = 0; i < from.size(); ++i) pairs.push_back({from[i], to.at(i)});
  const auto held = indices(recorded, "pinned_vertex");

  const auto solver = DeformationTransfer::create(target, pairs, held);
  ASSERT_TRUE(solver.has_value());
  const auto shape = solver->transfer(deformation_gradients(source, points(recorded, "source_deformed")));
  std::vector<double> flat;
  for (const Point3& p : shape.points) flat.insert(flat.end(), p.begin(), p.end());
  MIEN_EXPECT_CLOSE(flat, recorded.doubles("result"), "deformation transfer");
  const std::vector<double> energy = {shape.energy};
  MIEN_EXPECT_CLOSE(energy, recorded.doubles("energy"), "deformation transfer energy");
}

TEST(DeformationTransfer, FindsTheRecordedSolutions) {
  for_each_case("said", "", ".safetensors", [](const std::string& name) {
    if (!name.starts_with("deformation_transfer")) return;
    expect_recorded_solution(Fixture("said", name + ".safetensors"));
  });
}

}  // namespace
}  // namespace mien::parity
