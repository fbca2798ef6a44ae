#include "mien/face/flame_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "flame_equations.h"
#include "mien/base/contract.h"
#include "mien/base/parallel.h"
#include "mien/core/flame_parameters.h"

namespace mien {
namespace {

using face_detail::FlameEquations;
using Points = FlameEquations::Points;

constexpr int kMostIterations = 60;
constexpr double kSettled = 1e-12;  // decrease of the sum, relative
constexpr double kLeastDamping = 1e-12, kFirstDamping = 1e-6, kMostDamping = 1e6;

struct Frame {
  Eigen::VectorXd expression;
  Eigen::Vector3d jaw;
  Eigen::VectorXd squares;  // [V] squared distance
  int num_iterations = 0;
};

// Levenberg and Marquardt: the damping grows where a step raises the sum and shrinks where it does not.
Frame fit_frame(const FlameEquations& equations, const Points& target, double cost) {
  const Eigen::Index count = equations.num_expressions();
  FlameEquations::State state;
  state.expression = Eigen::VectorXd::Zero(count);
  state.rotation.setIdentity();
  equations.pose(state);
  Points residual = target - state.vertices;
  const auto sum_of = [&](const FlameEquations::State& s, const Points& r) {
    return r.squaredNorm() + cost * s.expression.squaredNorm();
  };
  double sum = sum_of(state, residual), damping = kFirstDamping;
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  Frame frame;
  bool is_settled = sum == 0;
  while (!is_settled && frame.num_iterations < kMostIterations) {
    ++frame.num_iterations;
    equations.linearise(state, residual, matrix, right);
    matrix.diagonal().array() += cost;  // of the jaw too, as a damping: a face without a jaw has a solution
    right.head(count) -= cost * state.expression;
    is_settled = true;  // unless a step helps
    for (; damping <= kMostDamping; damping *= 10) {
      Eigen::MatrixXd damped = matrix;
      damped.diagonal() *= 1 + damping;
      const Eigen::VectorXd step = damped.ldlt().solve(right);
      FlameEquations::State next;
      next.expression = state.expression + step.head(count);
      next.rotation = face_detail::rotation_about(step.tail(3)) * state.rotation;
      equations.pose(next);
      const Points left = target - next.vertices;
      const double lower = sum_of(next, left);
      if (!(lower < sum)) continue;
      is_settled = sum - lower <= kSettled * sum;
      state = std::move(next), residual = left, sum = lower;
      damping = std::max(damping / 10, kLeastDamping);
      break;
    }
  }
  frame.expression = state.expression;
  frame.jaw = face_detail::rotation_vector(state.rotation);
  frame.squares = residual.rowwise().squaredNorm();
  return frame;
}

Points points_of(const Motion& sequence, std::int64_t n, const std::vector<std::uint32_t>& vertices) {
  const auto frame = sequence.frame(n);
  Points points(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      points(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          static_cast<double>(frame[3 * static_cast<std::size_t>(vertices[i]) + k]);
  return points;
}

// Places of a region's vertices among those that count.
std::vector<Eigen::Index> places_of(const std::vector<std::uint32_t>& region,
                                    const std::vector<std::uint32_t>& vertices) {
  std::vector<Eigen::Index> places;
  for (const std::uint32_t v : region)
    if (const auto found = std::find(vertices.begin(), vertices.end(), v); found != vertices.end())
      places.push_back(found - vertices.begin());
  return places;
}

Status check(const FlameModel& model, const Motion& sequence, std::int64_t num_expressions) {
  if (sequence.space != MotionSpace::vertices || sequence.topology.num_vertices != model.num_vertices)
    return Error{Errc::incompatible, "fit",
                 "the sequence has " + std::to_string(sequence.topology.num_vertices) +
                     " vertices, the FLAME model has " + std::to_string(model.num_vertices),
                 "FLAME is fitted to meshes of its own topology"};
  const auto given = model.num_shapes - static_cast<std::int64_t>(kNumFlameShape);
  if (num_expressions > given)
    return Error{Errc::incompatible, "FLAME model",
                 "has " + std::to_string(given) + " expressions, " + std::to_string(num_expressions) +
                     " were asked for",
                 ""};
  const auto width = static_cast<std::size_t>(sequence.num_channels());
  for (std::size_t i = 0; i < sequence.values.size(); ++i)
    if (!std::isfinite(sequence.values[i]))
      return Error{Errc::input, "sequence", "frame " + std::to_string(i / width) + " is not finite", ""};
  return Done{};
}

}  // namespace

Result<FlameFitResult> fit_flame(const FlameModel& model, const Motion& sequence,
                                 std::span<const std::uint32_t> vertices,
                                 const std::map<std::string, std::vector<std::uint32_t>>& regions,
                                 const FlameFitOptions& options, Progress& progress) {
  contract(options.expression_cost > 0, "fit_flame: expressions must cost something");
  MIEN_TRY([[maybe_unused]] const auto fits, check(model, sequence, options.num_expressions));
  std::vector<std::uint32_t> taken(vertices.begin(), vertices.end());
  if (taken.empty()) {
    taken.resize(static_cast<std::size_t>(model.num_vertices));
    std::iota(taken.begin(), taken.end(), 0u);
  }
  const FlameEquations equations(model, taken, options.num_expressions);
  const double cost = static_cast<double>(taken.size()) * options.expression_cost * options.expression_cost;
  std::map<std::string, std::vector<Eigen::Index>> places;
  for (const auto& [name, region] : regions) places[name] = places_of(region, taken);

  const std::int64_t num_frames = sequence.num_frames();
  const auto width = static_cast<std::size_t>(options.num_expressions) + kNumFlameJaw;
  FlameFitResult result;
  result.parameters.space = MotionSpace::flame;
  result.parameters.channels = flame_channels(0, static_cast<std::size_t>(options.num_expressions));
  result.parameters.fps = sequence.fps;
  result.parameters.values.resize(static_cast<std::size_t>(num_frames) * width);
  result.residual.resize(static_cast<std::size_t>(num_frames));
  for (const auto& [name, region] : regions) result.region_residual[name].resize(result.residual.size());
  std::vector<int> iterations(result.residual.size());
  progress.stage("FLAME", num_frames);
  const std::int64_t batch = 8 * static_cast<std::int64_t>(std::max(1, options.num_threads));
  for (std::int64_t first = 0; first < num_frames; first += batch) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    const std::int64_t count = std::min(batch, num_frames - first);
    parallel_for(options.num_threads, count, [&](std::int64_t i) {
      const auto n = static_cast<std::size_t>(first + i);
      const Frame frame = fit_frame(equations, points_of(sequence, first + i, taken), cost);
      float* out = result.parameters.values.data() + n * width;
      for (Eigen::Index e = 0; e < frame.expression.size(); ++e)
        *out++ = static_cast<float>(frame.expression[e]);
      for (int k = 0; k < 3; ++k) *out++ = static_cast<float>(frame.jaw[k]);
      iterations[n] = frame.num_iterations;
      result.residual[n] = std::sqrt(frame.squares.mean());
      for (const auto& [name, of] : places) {
        double sum = 0;
        for (const Eigen::Index v : of) sum += frame.squares[v];
        result.region_residual.at(name)[n] = of.empty() ? 0 : std::sqrt(sum / static_cast<double>(of.size()));
      }
    });
    progress.update(first + count);
  }
  for (const int count : iterations) result.num_iterations = std::max(result.num_iterations, count);
  return result;
}

}  // namespace mien
