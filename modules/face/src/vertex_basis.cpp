#include "mien/face/vertex_basis.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"

namespace mien {
namespace {

using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr std::int64_t kMaxSampled = 256;
constexpr double kSafety = 0.999;  // shapes and coefficients are rounded after the remainder was measured
constexpr float kSmallestShape = 1e-7f;  // of the first component: below it lies rounding

// What is left of the sequence, [N, 3 V], while one direction after the other is taken out.
class Remainder {
 public:
  Remainder(const Motion& motion, int num_threads)
      : num_threads_(num_threads),
        rows_(Eigen::Map<const Rows>(motion.values.data(), motion.num_frames(), motion.num_channels())),
        mean_(static_cast<std::size_t>(motion.num_channels())),
        worst_(static_cast<std::size_t>(motion.num_frames())) {
    parallel_for(num_threads_, rows_.cols(), [&](std::int64_t c) {
      double sum = 0;
      for (std::int64_t n = 0; n < rows_.rows(); ++n) sum += static_cast<double>(rows_(n, c));
      mean_[static_cast<std::size_t>(c)] = static_cast<float>(sum / static_cast<double>(rows_.rows()));
      rows_.col(c).array() -= mean_[static_cast<std::size_t>(c)];
    });
    measure();
  }

  [[nodiscard]] const std::vector<float>& mean() const { return mean_; }
  [[nodiscard]] double max_error() const {
    return static_cast<double>(std::sqrt(*std::max_element(worst_.begin(), worst_.end())));
  }
  [[nodiscard]] const Rows& rows() const { return rows_; }
  [[nodiscard]] std::int64_t worst_frame() const {
    return std::max_element(worst_.begin(), worst_.end()) - worst_.begin();
  }

  /// Takes a direction of unit length out of every frame; returns how much of it each frame held, [N].
  std::vector<float> take(const Eigen::VectorXf& direction) {
    std::vector<float> amounts(worst_.size());
    parallel_for(num_threads_, rows_.rows(), [&](std::int64_t n) {
      const float amount = rows_.row(n).dot(direction);
      amounts[static_cast<std::size_t>(n)] = amount;
      rows_.row(n) -= amount * direction.transpose();
      measure(n);
    });
    return amounts;
  }

 private:
  void measure() {
    parallel_for(num_threads_, rows_.rows(), [&](std::int64_t n) { measure(n); });
  }
  void measure(std::int64_t n) {
    float worst = 0;
    const float* x = rows_.row(n).data();
    for (std::int64_t i = 0; i + 2 < rows_.cols(); i += 3)
      worst = std::max(worst, x[i] * x[i] + x[i + 1] * x[i + 1] + x[i + 2] * x[i + 2]);
    worst_[static_cast<std::size_t>(n)] = worst;
  }

  int num_threads_;
  Rows rows_;
  std::vector<float> mean_;
  std::vector<float> worst_;  // [N] square of the largest distance left
};

// Combinations of sampled frames, the strongest first.
struct Sampled {
  std::vector<std::int64_t> frames;
  Eigen::MatrixXf mixtures;  // [frames, components]
};

Sampled principal_mixtures(const Rows& rows) {
  Sampled sampled;
  const std::int64_t count = std::min<std::int64_t>(kMaxSampled, rows.rows());
  for (std::int64_t i = 0; i < count; ++i) sampled.frames.push_back(i * rows.rows() / count);
  Rows some(count, rows.cols());
  for (std::int64_t i = 0; i < count; ++i)
    some.row(i) = rows.row(sampled.frames[static_cast<std::size_t>(i)]);
  const Rows products = some * some.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(products.cast<double>());
  sampled.mixtures = solver.eigenvectors().rowwise().reverse().cast<float>();
  return sampled;
}

// One direction after the other is taken out until nothing above the error is left.
class BasisBuilder {
 public:
  BasisBuilder(const Motion& motion, const VertexBasisOptions& options)
      : options_(options), remainder_(motion, options.num_threads) {}

  Status build(Progress& progress) {
    progress.stage("shapes", 0);
    const Sampled sampled = principal_mixtures(remainder_.rows());
    for (std::int64_t k = 0; k < sampled.mixtures.cols() && is_wanting(); ++k) {
      Eigen::VectorXf direction = Eigen::VectorXf::Zero(remainder_.rows().cols());
      for (std::size_t i = 0; i < sampled.frames.size(); ++i)
        direction += sampled.mixtures(static_cast<std::int64_t>(i), k) *
                     remainder_.rows().row(sampled.frames[i]).transpose();
      if (!add(std::move(direction))) break;
      if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
      progress.update(static_cast<std::int64_t>(directions_.size()));
    }
    while (is_wanting() && add(remainder_.rows().row(remainder_.worst_frame()).transpose())) {
      if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
      progress.update(static_cast<std::int64_t>(directions_.size()));
    }
    return Done{};
  }

  VertexBasis finish(double fps) {
    if (directions_.empty()) {  // a still face: one shape that does nothing
      directions_.emplace_back(Eigen::VectorXf::Zero(remainder_.rows().cols()));
      amounts_.emplace_back(static_cast<std::size_t>(remainder_.rows().rows()), 0.0f);
    }
    VertexBasis basis;
    const std::size_t num_vertices = remainder_.mean().size() / 3;
    basis.neutral.resize(num_vertices);
    for (std::size_t v = 0; v < num_vertices; ++v)
      basis.neutral[v] = {remainder_.mean()[3 * v], remainder_.mean()[3 * v + 1],
                          remainder_.mean()[3 * v + 2]};
    basis.coefficients.space = MotionSpace::rig;
    basis.coefficients.fps = fps;
    const std::size_t num_shapes = directions_.size(), num_frames = amounts_[0].size();
    basis.coefficients.values.resize(num_frames * num_shapes);
    for (std::size_t k = 0; k < num_shapes; ++k) {
      float size = 0;
      for (const float a : amounts_[k]) size = std::max(size, std::abs(a));
      const std::string number = std::to_string(k);
      Blendshape shape{
          "shape" + std::string(number.size() < 3 ? 3 - number.size() : 0, '0') + number, {}, {}, {}};
      for (std::size_t v = 0; v < num_vertices; ++v) {
        const auto i = static_cast<std::int64_t>(3 * v);
        const Vec3 offset = size * Vec3{directions_[k][i], directions_[k][i + 1], directions_[k][i + 2]};
        if (offset == Vec3{} && v > 0) continue;
        shape.vertices.push_back(static_cast<std::uint32_t>(v));
        shape.offsets.push_back(offset);
      }
      for (std::size_t n = 0; n < num_frames; ++n)
        basis.coefficients.values[n * num_shapes + k] = size > 0 ? amounts_[k][n] / size : 0.0f;
      basis.coefficients.channels.push_back(shape.name);
      basis.shapes.push_back(std::move(shape));
    }
    return basis;
  }

 private:
  [[nodiscard]] bool is_wanting() const {
    return remainder_.max_error() > kSafety * options_.max_error &&
           static_cast<std::int64_t>(directions_.size()) < options_.max_shapes;
  }
  // False when there is no direction left but rounding.
  bool add(Eigen::VectorXf direction) {
    const double length = std::sqrt(direction.cast<double>().squaredNorm());
    if (directions_.empty()) first_length_ = length;
    if (!(length > static_cast<double>(kSmallestShape) * first_length_)) return false;
    direction /= static_cast<float>(length);
    amounts_.push_back(remainder_.take(direction));
    directions_.push_back(std::move(direction));
    return true;
  }

  const VertexBasisOptions& options_;
  Remainder remainder_;
  std::vector<Eigen::VectorXf> directions_;
  std::vector<std::vector<float>> amounts_;  // [K][N]
  double first_length_ = 0;
};

// Distances of what the stored numbers give from what was asked for.
void measure(const Motion& motion, int num_threads, VertexBasis& basis) {
  const auto num_frames = static_cast<std::size_t>(motion.num_frames());
  std::vector<double> largest(num_frames), squares(num_frames);
  parallel_for(num_threads, motion.num_frames(), [&](std::int64_t n) {
    std::vector<Vec3> posed(basis.neutral.size());
    evaluate_blendshapes(basis.neutral, basis.shapes, basis.coefficients.frame(n), posed);
    const auto truth = motion.frame(n);
    const auto at = static_cast<std::size_t>(n);
    for (std::size_t v = 0; v < posed.size(); ++v) {
      const double x = static_cast<double>(posed[v].x) - static_cast<double>(truth[3 * v]),
                   y = static_cast<double>(posed[v].y) - static_cast<double>(truth[3 * v + 1]),
                   z = static_cast<double>(posed[v].z) - static_cast<double>(truth[3 * v + 2]);
      const double square = x * x + y * y + z * z;
      largest[at] = std::max(largest[at], square);
      squares[at] += square;
    }
  });
  double sum = 0;
  for (const double s : squares) sum += s;
  basis.max_error = std::sqrt(*std::max_element(largest.begin(), largest.end()));
  basis.rms_error = std::sqrt(sum / static_cast<double>(num_frames * basis.neutral.size()));
}

}  // namespace

Result<VertexBasis> vertex_basis(const Motion& motion, const VertexBasisOptions& options,
                                 Progress& progress) {
  contract(motion.space == MotionSpace::vertices && options.max_error > 0 && options.max_shapes > 0,
           "vertex_basis: a motion of vertices and positive limits expected");
  if (motion.num_frames() == 0) return Error{Errc::input, "motion", "has no frames", ""};
  const auto width = static_cast<std::size_t>(motion.num_channels());
  for (std::size_t i = 0; i < motion.values.size(); ++i)
    if (!std::isfinite(motion.values[i]))
      return Error{Errc::input, "motion",
                   motion.channel_name(static_cast<std::int64_t>(i % width)) + " of frame " +
                       std::to_string(i / width) + " is not finite",
                   ""};
  BasisBuilder builder(motion, options);
  MIEN_TRY([[maybe_unused]] const auto built, builder.build(progress));
  VertexBasis basis = builder.finish(motion.fps);
  measure(motion, options.num_threads, basis);
  Result<VertexBasis> result(std::move(basis));
  if (result->max_error > options.max_error)
    result.warnings.push_back(std::to_string(result->shapes.size()) + " shapes leave an error of " +
                              fixed(result->max_error, 9) + " units, more than the " +
                              fixed(options.max_error, 9) + " asked for");
  return result;
}

}  // namespace mien
