#include "mien/metrics/take_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mean_of_defined.h"
#include "mien/base/contract.h"
#include "undefined.h"

namespace mien {
namespace {

template <class A, class B>
double squared_distance(std::span<const A> a, std::span<const B> b, std::size_t vertex) {
  double sum = 0;
  for (std::size_t i = 3 * vertex; i < 3 * vertex + 3; ++i) {
    const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += d * d;
  }
  return sum;
}

template <class A>
double largest_error(std::span<const float> truth, std::span<const A> predicted,
                     const std::vector<std::uint32_t>& mouth) {
  double worst = 0;
  for (const std::uint32_t v : mouth) worst = std::max(worst, squared_distance(truth, predicted, v));
  return worst;
}

double mean_distance(const Motion& a, const Motion& b, std::int64_t num_frames) {
  const auto num_vertices = static_cast<std::size_t>(a.topology.num_vertices);
  double sum = 0;
  for (std::int64_t n = 0; n < num_frames; ++n)
    for (std::size_t v = 0; v < num_vertices; ++v)
      sum += std::sqrt(squared_distance(a.frame(n), b.frame(n), v));
  return sum / (static_cast<double>(num_frames) * static_cast<double>(num_vertices));
}

double mean_estimate_error(const Motion& truth, std::span<const Motion> takes, std::int64_t num_frames,
                           const std::vector<std::uint32_t>& mouth) {
  std::vector<double> mean(static_cast<std::size_t>(truth.num_channels()));
  double sum = 0;
  for (std::int64_t n = 0; n < num_frames; ++n) {
    std::fill(mean.begin(), mean.end(), 0.0);
    for (const Motion& take : takes)
      for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += static_cast<double>(take.frame(n)[i]);
    for (double& m : mean) m /= static_cast<double>(takes.size());
    sum += largest_error(truth.frame(n), std::span<const double>(mean), mouth);
  }
  return sum / static_cast<double>(num_frames);
}

double coverage_error(const Motion& truth, std::span<const Motion> takes, std::int64_t num_frames,
                      const std::vector<std::uint32_t>& mouth) {
  double least = std::numeric_limits<double>::infinity();
  for (const Motion& take : takes) {
    double sum = 0;
    for (std::int64_t n = 0; n < num_frames; ++n) sum += largest_error(truth.frame(n), take.frame(n), mouth);
    least = std::min(least, sum);
  }
  return least / static_cast<double>(num_frames);
}

double paired_diversity(std::span<const Motion> takes, std::span<const std::size_t> order,
                        std::int64_t num_frames) {
  const std::size_t half = takes.size() / 2;
  double sum = 0;
  for (std::size_t i = 0; i < half; ++i)
    sum += mean_distance(takes[order[i]], takes[order[half + i]], num_frames);
  return sum / static_cast<double>(half);
}

// Mean over all frames of all sequences, of those that have a value.
double mean_by_frames(const std::vector<TakeError>& sequences, double TakeError::*value) {
  double sum = 0, count = 0;
  for (const TakeError& e : sequences) {
    if (std::isnan(e.*value)) continue;
    sum += e.*value * static_cast<double>(e.num_frames);
    count += static_cast<double>(e.num_frames);
  }
  return count > 0 ? sum / count : kNan;
}

}  // namespace

Status TakeErrors::add(std::string name, const Motion& truth, std::span<const Motion> takes,
                       std::span<const std::size_t> order) {
  std::vector<bool> seen(takes.size());
  contract(!takes.empty() && order.size() == takes.size(),
           "TakeErrors::add: takes and an order of them expected");
  for (const std::size_t take : order) {
    contract(take < takes.size() && !seen[take],
             "TakeErrors::add: the order names a take twice or one too many");
    seen[take] = true;
  }
  const auto fail = [&](std::string why) {
    return Error{Errc::incompatible, "'" + name + "'", std::move(why), ""};
  };
  if (truth.space != MotionSpace::vertices) return fail("the truth is not a motion of vertices");
  TakeError own{std::move(name), truth.num_frames(), kNan, kNan, kNan};
  for (const Motion& take : takes) {
    if (take.space != MotionSpace::vertices || take.topology.num_vertices != truth.topology.num_vertices)
      return fail("a take does not move the " + std::to_string(truth.topology.num_vertices) +
                  " vertices of the truth");
    own.num_frames = std::min(own.num_frames, take.num_frames());
  }
  for (const std::uint32_t v : mouth_)
    if (v >= truth.topology.num_vertices)
      return fail("a region names vertex " + std::to_string(v) + " of " +
                  std::to_string(truth.topology.num_vertices));
  if (own.num_frames > 0 && !mouth_.empty()) {
    own.mee = mean_estimate_error(truth, takes, own.num_frames, mouth_);
    own.ce = coverage_error(truth, takes, own.num_frames, mouth_);
  }
  if (own.num_frames > 0 && takes.size() > 1) own.diversity = paired_diversity(takes, order, own.num_frames);
  sequences_.push_back(std::move(own));
  return Done{};
}

double TakeErrors::mee() const { return mean_by_frames(sequences_, &TakeError::mee); }
double TakeErrors::ce() const { return mean_by_frames(sequences_, &TakeError::ce); }
double TakeErrors::diversity() const {
  return mean_of_defined(sequences_, [](const TakeError& e) { return e.diversity; });
}

}  // namespace mien
