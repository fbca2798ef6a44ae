#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace mien::head {

/// Fills the unknown rows of `values` so that d^T (bending L^2 + L) d is least, L the Laplacian of the graph
/// with unit weights: values flow smoothly from the known vertices over the edges.
///
/// @param edges   undirected, each once
/// @param known   [V] rows of `values` that are given
/// @param values  [V][2]
void smooth_over_graph(const std::vector<std::array<std::uint32_t, 2>>& edges, double bending,
                       const std::vector<bool>& known, std::vector<std::array<double, 2>>& values);

}  // namespace mien::head
