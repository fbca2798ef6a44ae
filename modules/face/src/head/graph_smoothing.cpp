#include "head/graph_smoothing.h"

#include "head/constrained_solve.h"

namespace mien::head {

void smooth_over_graph(const std::vector<std::array<std::uint32_t, 2>>& edges, double bending,
                       const std::vector<bool>& known, std::vector<std::array<double, 2>>& values) {
  const auto n = static_cast<int>(values.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& edge : edges) {
    const auto a = static_cast<int>(edge[0]), b = static_cast<int>(edge[1]);
    entries.emplace_back(a, a, 1.0);
    entries.emplace_back(b, b, 1.0);
    entries.emplace_back(a, b, -1.0);
    entries.emplace_back(b, a, -1.0);
  }
  ConstrainedSolve::Matrix laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const ConstrainedSolve::Matrix squared = laplacian * laplacian;
  const ConstrainedSolve solve(bending * squared + laplacian, known);

  Eigen::MatrixXd x(n, 2);
  for (int i = 0; i < n; ++i) {
    const auto& value = values[static_cast<std::size_t>(i)];
    x.row(i) << value[0], value[1];
  }
  solve.fill(x);
  for (int i = 0; i < n; ++i) values[static_cast<std::size_t>(i)] = {x(i, 0), x(i, 1)};
}

}  // namespace mien::head
