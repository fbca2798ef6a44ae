#include "head/constrained_solve.h"

#include "mien/base/contract.h"

namespace mien::head {

ConstrainedSolve::ConstrainedSolve(const Matrix& k, const std::vector<bool>& known) {
  contract(k.rows() == k.cols() && static_cast<std::size_t>(k.rows()) == known.size(),
           "ConstrainedSolve: matrix and known rows differ in size");
  const auto n = static_cast<int>(k.rows());
  std::vector<int> place(known.size());  // row within its block
  for (int i = 0; i < n; ++i) {
    auto& block = known[static_cast<std::size_t>(i)] ? known_ : unknown_;
    place[static_cast<std::size_t>(i)] = static_cast<int>(block.size());
    block.push_back(i);
  }
  std::vector<Eigen::Triplet<double>> inner, outer;
  for (int column = 0; column < n; ++column)
    for (Matrix::InnerIterator it(k, column); it; ++it) {
      const auto r = static_cast<std::size_t>(it.row()), c = static_cast<std::size_t>(column);
      if (known[r]) continue;
      (known[c] ? outer : inner).emplace_back(place[r], place[c], it.value());
    }
  const auto num_unknown = static_cast<int>(unknown_.size());
  Matrix block(num_unknown, num_unknown);
  block.setFromTriplets(inner.begin(), inner.end());
  coupling_.resize(num_unknown, static_cast<int>(known_.size()));
  coupling_.setFromTriplets(outer.begin(), outer.end());
  factor_.compute(block);
  contract(factor_.info() == Eigen::Success, "ConstrainedSolve: the matrix is not positive definite");
}

void ConstrainedSolve::fill(Eigen::MatrixXd& x) const {
  const auto num_known = static_cast<Eigen::Index>(known_.size());
  Eigen::MatrixXd given(num_known, x.cols());
  for (Eigen::Index i = 0; i < num_known; ++i) given.row(i) = x.row(known_[static_cast<std::size_t>(i)]);
  const Eigen::MatrixXd rhs = -(coupling_ * given);
  const Eigen::MatrixXd found = factor_.solve(rhs);
  for (Eigen::Index i = 0; i < found.rows(); ++i) x.row(unknown_[static_cast<std::size_t>(i)]) = found.row(i);
}

}  // namespace mien::head
