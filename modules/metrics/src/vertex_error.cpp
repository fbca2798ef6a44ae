#include "mien/metrics/vertex_error.h"

#include <algorithm>
#include <cmath>

#include "mean_of_defined.h"
#include "mien/base/contract.h"
#include "undefined.h"

namespace mien {
namespace {

// |a - b|^2 of one vertex.
double squared_distance(std::span<const float> a, std::span<const float> b, std::size_t v) {
  double sum = 0;
  for (std::size_t i = 3 * v; i < 3 * v + 3; ++i) {
    const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += d * d;
  }
  return sum;
}

// Mean over vertices of the standard deviation over the first frames of the squared distance from the
// neutral.
double movement(const Motion& motion, std::int64_t num_frames, std::span<const float> neutral,
                std::span<const std::uint32_t> vertices) {
  double sum = 0;
  const auto count = static_cast<double>(num_frames);
  for (const std::uint32_t v : vertices) {
    double mean = 0, squares = 0;
    for (std::int64_t n = 0; n < num_frames; ++n)
      mean += squared_distance(motion.frame(n), neutral, v) / count;
    for (std::int64_t n = 0; n < num_frames; ++n) {
      const double d = squared_distance(motion.frame(n), neutral, v) - mean;
      squares += d * d;
    }
    sum += std::sqrt(squares / count);
  }
  return sum / static_cast<double>(vertices.size());
}

}  // namespace

Status VertexErrors::add(std::string name, const Motion& truth, const Motion& predicted,
                         std::span<const float> neutral) {
  const auto fail = [&](std::string why) {
    return Error{Errc::incompatible, "'" + name + "'", std::move(why), ""};
  };
  if (truth.space != MotionSpace::vertices || predicted.space != MotionSpace::vertices)
    return fail("is not a pair of motions of vertices");
  const auto num_vertices = static_cast<std::size_t>(truth.topology.num_vertices);
  if (predicted.topology.num_vertices != truth.topology.num_vertices)
    return fail("has " + std::to_string(predicted.topology.num_vertices) +
                " vertices in the prediction and " + std::to_string(num_vertices) + " in the truth");
  if (!neutral.empty() && neutral.size() != 3 * num_vertices)
    return fail("the neutral mesh has " + std::to_string(neutral.size() / 3) + " vertices, the motion " +
                std::to_string(num_vertices));
  for (const auto* region : {&regions_.mouth, &regions_.upper})
    for (const std::uint32_t v : *region)
      if (v >= num_vertices)
        return fail("a region names vertex " + std::to_string(v) + " of " + std::to_string(num_vertices));

  VertexError own{std::move(name), std::min(truth.num_frames(), predicted.num_frames()), kNan, kNan, kNan};
  double distances = 0, mouth = 0;
  for (std::int64_t n = 0; n < own.num_frames; ++n) {
    const auto g = truth.frame(n), p = predicted.frame(n);
    for (std::size_t v = 0; v < num_vertices; ++v) distances += std::sqrt(squared_distance(g, p, v));
    double worst = 0;
    for (const std::uint32_t v : regions_.mouth) worst = std::max(worst, squared_distance(g, p, v));
    mouth += worst;
  }
  if (own.num_frames > 0) {
    const auto count = static_cast<double>(own.num_frames);
    own.mve = distances / (count * static_cast<double>(num_vertices));
    if (!regions_.mouth.empty()) own.lve = mouth / count;
    if (!regions_.upper.empty() && !neutral.empty())
      own.fdd = movement(truth, own.num_frames, neutral, regions_.upper) -
                movement(predicted, own.num_frames, neutral, regions_.upper);
  }
  distance_sum_ += distances;
  mouth_sum_ += mouth;
  num_frames_ += own.num_frames;
  num_distances_ += static_cast<double>(own.num_frames) * static_cast<double>(num_vertices);
  sequences_.push_back(std::move(own));
  return Done{};
}

double VertexErrors::mve() const { return num_distances_ > 0 ? distance_sum_ / num_distances_ : kNan; }

double VertexErrors::lve() const {
  if (num_frames_ == 0 || regions_.mouth.empty()) return kNan;
  return mouth_sum_ / static_cast<double>(num_frames_);
}

double VertexErrors::fdd() const {
  return mean_of_defined(sequences_, [](const VertexError& e) { return e.fdd; });
}

double VertexErrors::absolute_fdd() const {
  return mean_of_defined(sequences_, [](const VertexError& e) { return std::abs(e.fdd); });
}

double take_diversity(std::span<const Motion> takes) {
  if (takes.size() < 2) return kNan;
  std::int64_t num_frames = takes[0].num_frames();
  for (const Motion& take : takes) {
    contract(
        take.space == MotionSpace::vertices && take.topology.num_vertices == takes[0].topology.num_vertices,
        "take_diversity: motions of one topology expected");
    num_frames = std::min(num_frames, take.num_frames());
  }
  if (num_frames == 0) return kNan;
  const auto num_vertices = static_cast<std::size_t>(takes[0].topology.num_vertices);
  double sum = 0;
  for (std::size_t a = 0; a < takes.size(); ++a)
    for (std::size_t b = a + 1; b < takes.size(); ++b)
      for (std::int64_t n = 0; n < num_frames; ++n)
        for (std::size_t v = 0; v < num_vertices; ++v)
          sum += std::sqrt(squared_distance(takes[a].frame(n), takes[b].frame(n), v));
  const auto pairs = static_cast<double>(takes.size() * (takes.size() - 1) / 2);
  return sum / (pairs * static_cast<double>(num_frames) * static_cast<double>(num_vertices));
}

}  // namespace mien
