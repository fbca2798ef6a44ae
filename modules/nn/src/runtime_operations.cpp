#include "mien/nn/runtime_operations.h"

#include <algorithm>

#include "mien/base/contract.h"

namespace mien {
namespace {

// A single row applies to all rows: ops.h takes it without its row axis.
Tensor as_row_vector(const Tensor& y) { return y.reshaped({y.width()}); }

}  // namespace

Tensor Operations<Tensor>::add(Tensor x, const Tensor& y) {
  if (y.num_rows() == 1 && x.num_rows() != 1) return mien::add(std::move(x), as_row_vector(y));
  return mien::add(std::move(x), y);
}

Tensor Operations<Tensor>::mul(Tensor x, const Tensor& y) {
  if (y.num_rows() == 1 && x.num_rows() != 1) return mien::mul(std::move(x), as_row_vector(y));
  return mien::mul(std::move(x), y);
}

Tensor Operations<Tensor>::gru(const Tensor& x, Tensor& state, const Matrix& w_ih, const Matrix& w_hh,
                               const Tensor& b_ih, const Tensor& b_hh) {
  const std::int64_t hidden = w_hh.num_inputs();
  const Tensor projected = mien::linear(x, w_ih, b_ih);
  Tensor out = Tensor::uninitialized({x.num_rows(), hidden});
  for (std::int64_t n = 0; n < x.num_rows(); ++n) {
    state = gru_step_projected(mien::rows(projected, n, 1), state, w_hh, b_hh);
    std::copy(state.values().begin(), state.values().end(), out.row(n).begin());
  }
  return out;
}

Tensor Operations<Tensor>::one_hot(const Tensor&, std::int64_t index, std::int64_t width) {
  contract(index >= 0 && index < width, "one_hot: the index is not below the width");
  Tensor row({1, width});
  row.data()[index] = 1;
  return row;
}

Tensor Operations<Tensor>::table_row(const Tensor& table, std::int64_t index) {
  contract(index >= 0 && index < table.num_rows(), "table_row: there is no such row");
  return Tensor({1, table.width()}, table.row(index));
}

Tensor Operations<Tensor>::add_one(Tensor x) {
  for (float& v : x.values()) v += 1.0f;
  return x;
}

Tensor Operations<Tensor>::concat_rows(const std::vector<Tensor>& parts) {
  contract(!parts.empty(), "concat_rows: at least one part is needed");
  std::int64_t num_rows = 0;
  for (const Tensor& p : parts) num_rows += p.num_rows();
  Tensor out = Tensor::uninitialized({num_rows, parts.front().width()});
  float* to = out.data();
  for (const Tensor& p : parts) {
    contract(p.width() == out.width(), "concat_rows: widths differ");
    to = std::copy(p.values().begin(), p.values().end(), to);
  }
  return out;
}

}  // namespace mien
