#pragma once
#include <Eigen/Sparse>
#include <vector>

namespace mien::head {

/// One symmetric positive matrix with some rows known: a sparse Cholesky factor of the unknown block and the
/// coupling to the known one. Minimises x^T K x over the unknown rows for any number of right-hand sides.
class ConstrainedSolve {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// @pre at least one row is unknown and its block is positive definite
  ConstrainedSolve(const Matrix& k, const std::vector<bool>& known);

  /// x [n, C]: reads the known rows, writes the unknown ones.
  void fill(Eigen::MatrixXd& x) const;

 private:
  std::vector<int> unknown_;  // row of x for each row of the block
  std::vector<int> known_;
  Matrix coupling_;  // [unknown, known]
  Eigen::SimplicialLDLT<Matrix> factor_;
};

}  // namespace mien::head
