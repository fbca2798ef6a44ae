// Coefficients of vertex sequences (SAiD specification, section 10.4): recorded problems with their exact
// optimum.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "closeness.h"
#include "fixture.h"
#include "mien/fit/rate_limited_qp.h"

namespace mien::parity {
namespace {

// The <case>s of tensors named <case>.x in a file.
std::set<std::string> problems_of(const Fixture& recorded) {
  std::set<std::string> names;
  for (const StoredTensor& tensor : recorded.file().tensors())
    if (tensor.name.ends_with(".x")) names.insert(tensor.name.substr(0, tensor.name.size() - 2));
  return names;
}

double objective(std::int64_t k, const std::vector<double>& p, const std::vector<double>& q,
                 const std::vector<double>& u) {
  double sum = 0;
  for (std::size_t n = 0; n < u.size(); n += static_cast<std::size_t>(k))
    for (std::int64_t i = 0; i < k; ++i) {
      sum += q[n + i] * u[n + i];
      for (std::int64_t j = 0; j < k; ++j) sum += 0.5 * u[n + i] * p[i * k + j] * u[n + j];
    }
  return sum;
}

void expect_recorded_optimum(const Fixture& recorded, const std::string& name) {
  const auto p = recorded.doubles(name + ".P_block"), q = recorded.doubles(name + ".q");
  const auto* block = recorded.file().find(name + ".P_block");
  const std::int64_t k = block->shape.at(0);
  Progress progress;
  const auto solution = solve(
      {.num_channels = k, .quadratic = p, .linear = q, .max_change = recorded.doubles(name + ".delta").at(0)},
      progress);
  ASSERT_TRUE(solution.has_value());
  MIEN_EXPECT_CLOSE(solution->curves, recorded.doubles(name + ".x"), "qp optimum");
  const std::vector<double> value = {objective(k, p, q, solution->curves)};
  MIEN_EXPECT_CLOSE(value, recorded.doubles(name + ".obj"), "qp objective");
}

TEST(RateLimitedQp, FindsTheRecordedOptima) {
  for_each_case("said", "", ".safetensors", [](const std::string& file) {
    if (!file.starts_with("qp")) return;
    const Fixture recorded("said", file + ".safetensors");
    const auto names = problems_of(recorded);
    EXPECT_FALSE(names.empty());
    for (const std::string& name : names) {
      SCOPED_TRACE(name);
      expect_recorded_optimum(recorded, name);
    }
  });
}

}  // namespace
}  // namespace mien::parity
