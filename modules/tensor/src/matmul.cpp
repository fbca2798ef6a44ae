#include "mien/tensor/matmul.h"

#include <algorithm>

#include "require.h"

namespace mien {

void matmul(const View& x, const PackedMatrix& w, const float* bias, float* y, int num_threads) {
  require(x.columns == w.num_inputs(), [&] {
    return "matmul: x has " + std::to_string(x.columns) + " columns, the weights " +
           std::to_string(w.num_inputs()) + " inputs";
  });
  if (x.rows == 0 || w.num_outputs() == 0) return;
  if (w.kernel() != nullptr) return w.kernel()->run(x, bias, y, num_threads);
  for (std::int64_t m = 0; m < x.rows; ++m, y += w.num_outputs()) {  // no inputs: the bias alone
    if (bias != nullptr)
      std::copy_n(bias, w.num_outputs(), y);
    else
      std::fill_n(y, w.num_outputs(), 0.0f);
  }
}

}  // namespace mien
