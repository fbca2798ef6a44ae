#include "mien/fit/coefficient_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/base/parallel.h"
#include "mien/fit/rate_limited_qp.h"

namespace mien {
namespace {

double exact_dot(const Vec3& a, const Vec3& b) {
  return static_cast<double>(a.x) * b.x + static_cast<double>(a.y) * b.y + static_cast<double>(a.z) * b.z;
}

// P = B^T B from the sparse columns: each shape spread out once, then met by the others.
std::vector<double> gram_matrix(std::size_t num_vertices, std::span<const Blendshape> shapes) {
  const std::size_t k = shapes.size();
  std::vector<double> gram(k * k);
  std::vector<Vec3> dense(num_vertices);
  for (std::size_t i = 0; i < k; ++i) {
    std::fill(dense.begin(), dense.end(), Vec3{});
    for (std::size_t m = 0; m < shapes[i].vertices.size(); ++m)
      dense[shapes[i].vertices[m]] = shapes[i].offsets[m];
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = 0;
      for (std::size_t m = 0; m < shapes[j].vertices.size(); ++m)
        sum += exact_dot(shapes[j].offsets[m], dense[shapes[j].vertices[m]]);
      gram[i * k + j] = gram[j * k + i] = sum;
    }
  }
  return gram;
}

std::vector<Vec3> positions_of(const Motion& sequence, std::int64_t n, std::size_t num_vertices) {
  std::vector<Vec3> positions(num_vertices);
  copy_positions(sequence, n, positions);
  return positions;
}

double root_mean_square(std::span<const double> squares) {
  double sum = 0;
  for (const double s : squares) sum += s;
  return squares.empty() ? 0 : std::sqrt(sum / static_cast<double>(squares.size()));
}

}  // namespace

Result<FitResult> fit_coefficients(std::span<const Vec3> neutral, std::span<const Blendshape> shapes,
                                   const Motion& sequence, const FitRegions& regions,
                                   const FitOptions& options, Progress& progress) {
  contract(!shapes.empty(), "fit_coefficients: at least one shape");
  for (const Blendshape& shape : shapes)
    contract(shape.vertices.empty() || shape.vertices.back() < neutral.size(),
             "fit_coefficients: a shape moves a vertex that the face does not have");
  if (sequence.space != MotionSpace::vertices ||
      sequence.topology.num_vertices != static_cast<std::int64_t>(neutral.size()))
    return Error{Errc::incompatible, "fit",
                 "the sequence has " + std::to_string(sequence.topology.num_vertices) +
                     " vertices, the face with the shapes has " + std::to_string(neutral.size()),
                 "Make shapes for the sequence's own mesh first (mien transfer)"};

  const std::size_t k = shapes.size();
  const std::int64_t num_frames = sequence.num_frames();
  std::vector<double> linear(static_cast<std::size_t>(num_frames) * k);
  parallel_for(options.num_threads, num_frames, [&](std::int64_t n) {
    const auto positions = positions_of(sequence, n, neutral.size());
    for (std::size_t i = 0; i < k; ++i) {
      double sum = 0;
      for (std::size_t m = 0; m < shapes[i].vertices.size(); ++m) {
        const auto v = shapes[i].vertices[m];
        sum += exact_dot(shapes[i].offsets[m], neutral[v] - positions[v]);
      }
      linear[static_cast<std::size_t>(n) * k + i] = sum;
    }
  });

  const std::vector<double> gram = gram_matrix(neutral.size(), shapes);
  MIEN_TRY(const QpSolution solution, solve({.num_channels = static_cast<std::int64_t>(k),
                                             .quadratic = gram,
                                             .linear = linear,
                                             .lower = options.lower,
                                             .upper = options.upper,
                                             .max_change = options.max_change},
                                            progress));

  FitResult result;
  result.num_iterations = solution.num_iterations;
  result.coefficients.space = MotionSpace::arkit;
  result.coefficients.fps = sequence.fps;
  for (const Blendshape& shape : shapes) result.coefficients.channels.push_back(shape.name);
  result.coefficients.values.assign(solution.curves.begin(), solution.curves.end());
  result.residual.resize(static_cast<std::size_t>(num_frames));
  for (const auto& [name, vertices] : regions)
    result.region_residual[name].resize(static_cast<std::size_t>(num_frames));
  parallel_for(options.num_threads, num_frames, [&](std::int64_t n) {
    const auto positions = positions_of(sequence, n, neutral.size());
    std::vector<Vec3> fitted(neutral.size());
    evaluate_blendshapes(neutral, shapes, result.coefficients.frame(n), fitted);
    std::vector<double> squares(neutral.size());
    for (std::size_t v = 0; v < squares.size(); ++v) {
      const Vec3 miss = positions[v] - fitted[v];
      squares[v] = exact_dot(miss, miss);
    }
    result.residual[static_cast<std::size_t>(n)] = root_mean_square(squares);
    for (const auto& [name, vertices] : regions) {
      std::vector<double> part;
      for (const auto v : vertices)
        if (v < squares.size()) part.push_back(squares[v]);
      result.region_residual.at(name)[static_cast<std::size_t>(n)] = root_mean_square(part);
    }
  });
  return result;
}

}  // namespace mien
