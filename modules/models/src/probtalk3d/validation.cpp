#include "mien/models/probtalk3d/validation.h"

#include <cmath>
#include <limits>
#include <vector>

#include "mien/base/contract.h"

namespace mien::probtalk3d {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = 1e-10;  // the programs add it to a frequency before its logarithm

double sample_variance(const Tensor& x, std::size_t column) {
  double sum = 0, squares = 0;
  for (std::int64_t n = 0; n < x.num_rows(); ++n) sum += static_cast<double>(x.row(n)[column]);
  const double mean = sum / static_cast<double>(x.num_rows());
  for (std::int64_t n = 0; n < x.num_rows(); ++n) {
    const double behind = static_cast<double>(x.row(n)[column]) - mean;
    squares += behind * behind;
  }
  return squares / static_cast<double>(x.num_rows() - 1);
}

}  // namespace

double code_perplexity(std::span<const std::int64_t> codes, std::int64_t num_codes) {
  if (codes.empty()) return kNan;
  std::vector<double> share(static_cast<std::size_t>(num_codes));
  for (const std::int64_t code : codes) {
    contract(code >= 0 && code < num_codes, "code_perplexity: there is no such code");
    share[static_cast<std::size_t>(code)] += 1.0 / static_cast<double>(codes.size());
  }
  double entropy = 0;
  for (const double e : share) entropy -= e * std::log(e + kTiny);
  return std::exp(entropy);
}

MotionDistance motion_distance(const Tensor& predicted, const Tensor& truth) {
  contract(predicted.num_rows() == truth.num_rows() && predicted.width() == truth.width(),
           "motion_distance: the motions have other sizes");
  const std::int64_t num_frames = truth.num_rows();
  if (num_frames == 0) return {kNan, kNan};
  double norms = 0;
  for (std::int64_t n = 0; n < num_frames; ++n) {
    double squares = 0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(truth.width()); ++c) {
      const double error = static_cast<double>(predicted.row(n)[c]) - static_cast<double>(truth.row(n)[c]);
      squares += error * error;
    }
    norms += std::sqrt(squares);
  }
  double squares = 0;
  for (std::size_t c = 0; c < static_cast<std::size_t>(truth.width()); ++c) {
    const double behind = sample_variance(predicted, c) - sample_variance(truth, c);
    squares += behind * behind;
  }
  return {norms / static_cast<double>(num_frames), std::sqrt(squares)};
}

}  // namespace mien::probtalk3d
