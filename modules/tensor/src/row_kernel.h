#pragma once
// The kernels of elementwise_kernel.h that see a row, or columns of rows, as a whole. Sums are in an order
// that depends on sizes alone, so every instruction set gives the same bits. Vectors wider than a register
// are pieces of several; they stay inside functions, because they have no calling convention.
#include "elementwise.h"

namespace mien::elementwise {
namespace {

typedef float EightFloats __attribute__((vector_size(32)));
typedef double EightDoubles __attribute__((vector_size(64)));

/// Sum of eight partial sums.
inline double joined(const double* s) {
  return ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
}

/// Sum of in[i], or of the squares of in[i] - mean, in double: 8 interleaved partial sums.
template <bool kSquares>
double ordered_sum(const float* in, std::int64_t count, double mean) {
  EightDoubles sums = {};
  std::int64_t i = 0;
  for (; i + 8 <= count; i += 8) {
    EightFloats values;
    __builtin_memcpy(&values, in + i, sizeof values);
    EightDoubles v = __builtin_convertvector(values, EightDoubles);
    if constexpr (kSquares) {
      v -= mean;
      v *= v;
    }
    sums += v;
  }
  double s[8];
  __builtin_memcpy(s, &sums, sizeof s);
  for (int k = 0; i < count; ++i, ++k) {
    const double v = static_cast<double>(in[i]) - (kSquares ? mean : 0.0);
    s[k] += kSquares ? v * v : v;
  }
  return joined(s);
}

void layer_norm_row(const float* in, const float* gamma, const float* beta, double eps, std::int64_t width,
                    float* out) {
  const auto n = static_cast<double>(width);
  const double mean = ordered_sum<false>(in, width, 0) / n;
  const double variance = ordered_sum<true>(in, width, mean) / n;
  const double scale = 1.0 / __builtin_sqrt(variance + eps);
  std::int64_t i = 0;
  for (; i + 8 <= width; i += 8) {
    EightFloats values, factors, shifts;
    __builtin_memcpy(&values, in + i, sizeof values);
    __builtin_memcpy(&factors, gamma + i, sizeof factors);
    __builtin_memcpy(&shifts, beta + i, sizeof shifts);
    const EightDoubles normed = (__builtin_convertvector(values, EightDoubles) - mean) * scale;
    values = __builtin_convertvector(normed, EightFloats) * factors + shifts;
    __builtin_memcpy(out + i, &values, sizeof values);
  }
  for (; i < width; ++i)
    out[i] = static_cast<float>((static_cast<double>(in[i]) - mean) * scale) * gamma[i] + beta[i];
}

/// sums[i] = the sum over all rows of x[n, i], or of (x[n, i] - means[i])^2.
template <bool kSquares>
void column_sums(const GroupNormRows& job) {
  constexpr std::int64_t kBlock = 16;  // rows summed in float
  for (std::int64_t i = 0; i < job.width; ++i) job.sums[i] = 0;
  for (std::int64_t first = 0; first < job.rows; first += kBlock) {
    const std::int64_t count = job.rows - first < kBlock ? job.rows - first : kBlock;
    const float* block = job.x + first * job.width;
    std::int64_t i = 0;
    for (; i + kWidth <= job.width; i += kWidth) {
      const Floats mean = kSquares ? load(job.means + i) : all(0.0f);
      Floats sum = all(0.0f);
      for (std::int64_t r = 0; r < count; ++r) {
        Floats v = load(block + r * job.width + i);
        if constexpr (kSquares) {
          v -= mean;
          v *= v;
        }
        sum += v;
      }
      float lanes[kWidth];
      store(lanes, sum);
      for (int k = 0; k < kWidth; ++k) job.sums[i + k] += static_cast<double>(lanes[k]);
    }
    for (; i < job.width; ++i) {
      float sum = 0;
      for (std::int64_t r = 0; r < count; ++r) {
        const float v = block[r * job.width + i] - (kSquares ? job.means[i] : 0.0f);
        sum += kSquares ? v * v : v;
      }
      job.sums[i] += static_cast<double>(sum);
    }
  }
}

void group_norm_rows(const GroupNormRows& job) {
  const std::int64_t width = job.width, size = width / job.groups;
  const double count = static_cast<double>(job.rows) * static_cast<double>(size);
  /// The mean over a group of what column_sums() left.
  const auto mean_of = [&](std::int64_t first) {
    double sum = 0;
    for (std::int64_t i = first; i < first + size; ++i) sum += job.sums[i];
    return sum / count;
  };
  column_sums<false>(job);
  for (std::int64_t first = 0; first < width; first += size) {
    const auto mean = static_cast<float>(mean_of(first));
    for (std::int64_t i = first; i < first + size; ++i) job.means[i] = mean;
  }
  column_sums<true>(job);
  for (std::int64_t first = 0; first < width; first += size) {
    const double scale = 1.0 / __builtin_sqrt(mean_of(first) + job.eps);
    for (std::int64_t i = first; i < first + size; ++i)
      job.factors[i] = static_cast<float>(static_cast<double>(job.gamma[i]) * scale);
  }
  const auto normed = [&](Floats x, Floats mean, Floats factor, Floats beta) {
    const Floats y = (x - mean) * factor + beta;
    return job.silu ? Silu::apply(y) : y;
  };
  for (std::int64_t r = 0; r < job.rows; ++r) {
    const float* in = job.x + r * width;
    float* out = job.out + r * width;
    std::int64_t i = 0;
    for (; i + kWidth <= width; i += kWidth)
      store(out + i, normed(load(in + i), load(job.means + i), load(job.factors + i), load(job.beta + i)));
    const std::int64_t rest = width - i;
    if (rest > 0)
      store_some(out + i,
                 normed(load_some(in + i, rest), load_some(job.means + i, rest),
                        load_some(job.factors + i, rest), load_some(job.beta + i, rest)),
                 rest);
  }
}

/// The largest of a row; of one that holds NaN, any value: the softmax of such a row is NaN in any case.
float largest_of(const float* in, std::int64_t width) {
  float largest = in[0];
  Floats wide = all(largest);
  std::int64_t i = 0;
  for (; i + kWidth <= width; i += kWidth) {
    const Floats x = load(in + i);
    wide = x > wide ? x : wide;
  }
  float lanes[kWidth];
  store(lanes, wide);
  for (int half = kWidth / 2; half > 0; half /= 2)
    for (int k = 0; k < half; ++k) lanes[k] = lanes[k + half] > lanes[k] ? lanes[k + half] : lanes[k];
  largest = lanes[0] > largest ? lanes[0] : largest;
  for (; i < width; ++i) largest = in[i] > largest ? in[i] : largest;
  return largest;
}

float exp_row(const float* in, std::int64_t width, float* out) {
  const Floats largest = all(largest_of(in, width));
  std::int64_t i = 0;
  for (; i + kWidth <= width; i += kWidth) store(out + i, exp_of(load(in + i) - largest));
  const std::int64_t rest = width - i;
  if (rest > 0) store_some(out + i, exp_of(load_some(in + i, rest) - largest), rest);
  return static_cast<float>(ordered_sum<false>(out, width, 0));
}

void softmax_row(const float* in, std::int64_t width, float* out) {
  if (width == 0) return;
  const float sum = exp_row(in, width, out);
  for (std::int64_t i = 0; i < width; ++i) out[i] /= sum;
}

typedef float SixteenFloats __attribute__((vector_size(64)));

/// Sum of a[i] b[i]: 16 interleaved partial sums.
float dot(const float* a, const float* b, std::int64_t count) {
  SixteenFloats sums = {};
  std::int64_t i = 0;
  for (; i + 16 <= count; i += 16) {
    SixteenFloats x, y;
    __builtin_memcpy(&x, a + i, sizeof x);
    __builtin_memcpy(&y, b + i, sizeof y);
    sums += x * y;
  }
  float s[16];
  __builtin_memcpy(s, &sums, sizeof s);
  for (int k = 0; i < count; ++i, ++k) s[k] += a[i] * b[i];
  for (int half = 8; half > 0; half /= 2)
    for (int k = 0; k < half; ++k) s[k] += s[k + half];
  return s[0];
}

void band_row(const BandRow& job) {
  const std::int64_t width = job.width, count = job.count;
  for (std::int64_t h = 0; h < job.heads; ++h) {
    float* scores = job.scores + h * count;
    float largest = 0;
    for (std::int64_t t = 0; t < count; ++t) {
      scores[t] = dot(job.q + h * width, job.k + t * job.k_stride + h * width, width);
      largest = t == 0 || scores[t] > largest ? scores[t] : largest;
    }
    for (std::int64_t t = 0; t < count; ++t) scores[t] -= largest;
  }
  map<Exp>(job.scores, job.scores, job.heads * count);
  for (std::int64_t h = 0; h < job.heads; ++h) {
    float* weights = job.scores + h * count;
    double sum = 0;
    for (std::int64_t t = 0; t < count; ++t) sum += static_cast<double>(weights[t]);
    for (std::int64_t t = 0; t < count; ++t)
      weights[t] = static_cast<float>(static_cast<double>(weights[t]) / sum);
    const float* values = job.v + h * width;
    float* out = job.out + h * width;
    std::int64_t i = 0;
    for (; i + kWidth <= width; i += kWidth) {
      Floats mixed = all(0.0f);
      for (std::int64_t t = 0; t < count; ++t) mixed += all(weights[t]) * load(values + t * job.v_stride + i);
      store(out + i, mixed);
    }
    for (; i < width; ++i) {
      float mixed = 0;
      for (std::int64_t t = 0; t < count; ++t) mixed += weights[t] * values[t * job.v_stride + i];
      out[i] = mixed;
    }
  }
}

typedef std::int8_t Bytes __attribute__((vector_size(kWidth)));

/// Adding 1.5 * 2^23 leaves the rounded integer in the low bits.
inline Ints rounded(Floats x) { return (Ints)(x + 12582912.0f) - 0x4b400000; }

float quantise_row(const float* in, std::int64_t count, std::int8_t* out) {
  // The bits of floats that are not negative are ordered as the floats are, NaN above all.
  Ints most = {};
  std::int64_t i = 0;
  for (; i + kWidth <= count; i += kWidth) {
    const Ints bits = (Ints)absolute(load(in + i));
    most = bits > most ? bits : most;
  }
  if (i < count) {
    const Ints bits = (Ints)absolute(load_some(in + i, count - i));
    most = bits > most ? bits : most;
  }
  std::int32_t lanes[kWidth], largest_bits = 0;
  __builtin_memcpy(lanes, &most, sizeof lanes);
  for (const std::int32_t bits : lanes) largest_bits = bits > largest_bits ? bits : largest_bits;
  float largest;
  __builtin_memcpy(&largest, &largest_bits, sizeof largest);
  const float steps = 127.0f / largest;
  if (!__builtin_isfinite(largest) ||
      !__builtin_isfinite(steps)) {  // or zero, or so small that it is as good
    for (i = 0; i < count; ++i) out[i] = 0;
    return __builtin_isfinite(largest) ? 0.0f : __builtin_nanf("");
  }
  for (i = 0; i + kWidth <= count; i += kWidth) {
    const Bytes bytes = __builtin_convertvector(rounded(load(in + i) * steps), Bytes);
    __builtin_memcpy(out + i, &bytes, sizeof bytes);
  }
  if (i < count) {
    const Bytes bytes = __builtin_convertvector(rounded(load_some(in + i, count - i) * steps), Bytes);
    for (std::int64_t k = i; k < count; ++k) out[k] = bytes[k - i];
  }
  return largest / 127.0f;
}

void dequantise_row(const std::int32_t* sums, float step, const float* steps, const float* bias,
                    std::int64_t count, float* out) {
  std::int64_t i = 0;
  for (; i + kWidth <= count; i += kWidth) {
    Ints whole;
    __builtin_memcpy(&whole, sums + i, sizeof whole);
    const Floats start = bias != nullptr ? load(bias + i) : all(0.0f);
    store(out + i, __builtin_convertvector(whole, Floats) * (step * load(steps + i)) + start);
  }
  for (; i < count; ++i)
    out[i] = static_cast<float>(sums[i]) * (step * steps[i]) + (bias != nullptr ? bias[i] : 0.0f);
}

}  // namespace
}  // namespace mien::elementwise
