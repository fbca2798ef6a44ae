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

Tensor Operations<Tensor>::attention(const Tensor& q, const Tensor& k, const Tensor& v, std::int64_t heads,
                                     std::span<const std::int64_t> valid) {
  contract(valid.size() <= 1, "attention: the runtime has no batches");
  Tensor out = Tensor::uninitialized(q.shape());
  mien::attention({q.view(), k.view(), v.view(), heads, valid.empty() ? -1 : valid[0]}, out.data());
  return out;
}

Tensor Operations<Tensor>::attention_within(const Tensor& q, const Tensor& k, const Tensor& v,
                                            std::int64_t heads, std::span<const KeyRange> ranges) {
  Tensor out = Tensor::uninitialized(q.shape());
  mien::attention_within(q.view(), k.view(), v.view(), heads, ranges, out.data());
  return out;
}

Tensor Operations<Tensor>::given_rows(const Tensor&, std::span<const float> values, std::int64_t width) {
  contract(static_cast<std::int64_t>(values.size()) == width, "given_rows: the runtime has no batches");
  return Tensor({1, width}, values);
}

Tensor Operations<Tensor>::instance_norm(Tensor x, double eps) {
  Tensor ones({x.width()});
  std::ranges::fill(ones.values(), 1.0f);
  return mien::group_norm(std::move(x), ones, Tensor({ones.count()}), ones.count(), eps);
}

Tensor Operations<Tensor>::channel_runs(const Tensor& x, std::int64_t width) {
  contract(width > 0 && x.count() % width == 0, "channel_runs: the values are not whole rows");
  return transposed(x).reshaped({x.count() / width, width});
}

Tensor Operations<Tensor>::from_channel_runs(const Tensor& x, std::int64_t count) {
  contract(count > 0 && x.count() % count == 0, "from_channel_runs: the values are not whole rows");
  return transposed(x.reshaped({x.count() / count, count}));
}

Tensor Operations<Tensor>::squared_distances(const Tensor& x, const Tensor& table) {
  contract(x.width() == table.width(), "squared_distances: widths differ");
  const auto square_of = [](std::span<const float> row) {
    double sum = 0;
    for (const float v : row) sum += static_cast<double>(v) * v;
    return sum;
  };
  std::vector<double> of_table;
  for (std::int64_t k = 0; k < table.num_rows(); ++k) of_table.push_back(square_of(table.row(k)));
  Tensor out = mien::linear(x, PackedMatrix(table));
  for (std::int64_t n = 0; n < out.num_rows(); ++n) {
    const double own = square_of(x.row(n));
    const auto row = out.row(n);
    for (std::size_t k = 0; k < row.size(); ++k)
      row[k] = static_cast<float>(own + of_table[k] - 2.0 * static_cast<double>(row[k]));
  }
  return out;
}

Tensor Operations<Tensor>::zero_after(Tensor x, std::span<const std::int64_t> valid) {
  contract(valid.size() <= 1, "zero_after: the runtime has no batches");
  for (std::int64_t r = valid.empty() ? x.num_rows() : std::max<std::int64_t>(valid[0], 0); r < x.num_rows();
       ++r)
    std::ranges::fill(x.row(r), 0.0f);
  return x;
}

Tensor Operations<Tensor>::replace_rows(Tensor x, std::span<const std::uint8_t> flags, const Tensor& row) {
  contract(static_cast<std::int64_t>(flags.size()) == x.num_rows() && row.count() == x.width(),
           "replace_rows: one flag for each row and a row of the same width are needed");
  for (std::int64_t r = 0; r < x.num_rows(); ++r)
    if (flags[static_cast<std::size_t>(r)] != 0) std::ranges::copy(row.values(), x.row(r).begin());
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
