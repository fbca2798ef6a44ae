#include "mien/models/default/chunk_code.h"

#include <cmath>
#include <numbers>

#include "mien/base/contract.h"

namespace mien::default_model {

const DctMatrix& dct_matrix() {
  static const DctMatrix matrix = [] {
    DctMatrix m{};
    for (std::size_t k = 0; k < m.size(); ++k) {
      const double scale = std::sqrt((k == 0 ? 1.0 : 2.0) / kChunkSamples);
      for (std::size_t i = 0; i < m.size(); ++i)
        m[k][i] = static_cast<float>(scale * std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) *
                                                      static_cast<double>(k) / kChunkSamples));
    }
    return m;
  }();
  return matrix;
}

void encode_chunk(std::span<const float> samples, std::span<const float> last,
                  std::span<float> coefficients) {
  contract(samples.size() == kChunkSamples * last.size() && coefficients.size() == samples.size(),
           "encode_chunk: sizes disagree");
  const DctMatrix& m = dct_matrix();
  const std::size_t width = last.size();
  for (std::size_t k = 0; k < m.size(); ++k)
    for (std::size_t u = 0; u < width; ++u) {
      float sum = 0;
      for (std::size_t i = 0; i < m.size(); ++i) sum += m[k][i] * (samples[i * width + u] - last[u]);
      coefficients[k * width + u] = sum;
    }
}

void decode_chunk(std::span<const float> coefficients, std::span<const float> last,
                  std::span<float> samples) {
  contract(samples.size() == kChunkSamples * last.size() && coefficients.size() == samples.size(),
           "decode_chunk: sizes disagree");
  const DctMatrix& m = dct_matrix();
  const std::size_t width = last.size();
  for (std::size_t i = 0; i < m.size(); ++i)
    for (std::size_t u = 0; u < width; ++u) {
      float sum = last[u];
      for (std::size_t k = 0; k < m.size(); ++k) sum += m[k][i] * coefficients[k * width + u];
      samples[i * width + u] = sum;
    }
}

}  // namespace mien::default_model
