#pragma once
// Included once by each elementwise_<instruction set>.cpp after it has defined kWidth, the floats of a
// register. Internal linkage only, nothing from the standard library: see rowwise_kernel.h.
#include "elementwise.h"

namespace mien::elementwise {
namespace {

typedef float Floats __attribute__((vector_size(kWidth * 4)));
typedef std::int32_t Ints __attribute__((vector_size(kWidth * 4)));
typedef std::uint32_t Words __attribute__((vector_size(kWidth * 4)));
typedef std::uint16_t HalfWords __attribute__((vector_size(kWidth * 2)));

inline Floats all(float value) { return value - Floats{}; }
inline Floats load(const float* p) {
  Floats v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
inline void store(float* p, Floats v) { __builtin_memcpy(p, &v, sizeof v); }
/// The first `count` of a register, zeros behind them.
inline Floats load_some(const float* p, std::int64_t count) {
  float lanes[kWidth] = {};
  for (std::int64_t k = 0; k < count; ++k) lanes[k] = p[k];
  return load(lanes);
}
inline void store_some(float* p, Floats v, std::int64_t count) {
  float lanes[kWidth];
  store(lanes, v);
  for (std::int64_t k = 0; k < count; ++k) p[k] = lanes[k];
}
inline Floats absolute(Floats x) { return (Floats)((Ints)x & 0x7fffffff); }
/// `magnitude` (not negative) with the sign of x.
inline Floats with_sign(Floats magnitude, Floats x) {
  return (Floats)((Ints)magnitude | ((Ints)x & (Ints)all(-0.0f)));
}

/// e^x to 1 ulp, 0 and infinity beyond the range of float. e^x = 2^n e^r with |r| <= ln(2) / 2 and
/// e^r = 1 + r + r^2 P(r), P a minimax polynomial (relative error 3e-9).
inline Floats exp_of(Floats x) {
  x = x > 89.0f ? all(89.0f) : x;  // NaN passes: comparisons with it are false
  x = x < -104.0f ? all(-104.0f) : x;
  // Adding 1.5 * 2^23 rounds to an integer and leaves it in the low bits.
  const Floats shifted = x * 1.44269504f + 12582912.0f;
  const Floats n = shifted - 12582912.0f;
  const Ints exponent = (Ints)shifted - 0x4b400000;
  const Floats r =
      (x - n * 0.693359375f) - n * -2.12194440e-4f;  // ln(2) in two parts; n times the first is exact
  Floats p = r * 1.38146132255e-3f + 8.36871700075e-3f;
  p = p * r + 4.16683877825e-2f;
  p = p * r + 1.66665206305e-1f;
  p = p * r + 4.99999934489e-1f;
  const Floats e = (p * (r * r) + r) + 1.0f;
  const Ints half = exponent >> 1;  // 2^n in two factors: n may be below or above the exponents of float
  return e * (Floats)((half + 127) << 23) * (Floats)((exponent - half + 127) << 23);
}

struct Exp {
  static Floats apply(Floats x) { return exp_of(x); }
};
struct Sigmoid {
  static Floats apply(Floats x) { return 1.0f / (1.0f + exp_of(-x)); }
};
struct Silu {
  static Floats apply(Floats x) { return x / (1.0f + exp_of(-x)); }
};
struct Relu {
  static Floats apply(Floats x) { return x < 0.0f ? all(0.0f) : x; }
};
/// x tanh(ln(1 + e^x)) = x p / (p + 2) with p = e^x (e^x + 2), where nothing cancels. Beyond 20 it is x.
struct Mish {
  static Floats apply(Floats x) {
    const Floats e = exp_of(x > 20.0f ? all(20.0f) : x);
    const Floats p = e * (e + 2.0f);
    return x * (p / (p + 2.0f));
  }
};
/// Relative error below 2e-7: an odd minimax polynomial near 0, exponentials elsewhere.
struct Tanh {
  static Floats apply(Floats x) {
    const Floats a = absolute(x);
    const Floats u = x * x;
    Floats p = u * -5.71704274294e-3f + 2.06505852537e-2f;
    p = p * u + -5.37434975197e-2f;
    p = p * u + 1.33314912830e-1f;
    p = p * u + -3.33332839255e-1f;
    const Floats near = p * u * x + x;
    const Floats far = with_sign(1.0f - 2.0f / (exp_of(a + a) + 1.0f), x);
    return a < 0.625f ? near : far;
  }
};
/// x / 2 * (1 + erf(x / sqrt(2))), the exact form. erf is 1 - t P(t) e^(-a^2) with t = 1 / (1 + 0.45 a), P a
/// minimax polynomial (1e-9); its absolute error here is below 3e-7.
struct Gelu {
  static Floats apply(Floats x) {
    const Floats a = absolute(x) * 0.707106781f;
    const Floats t = 1.0f / (1.0f + a * 0.45f);
    Floats p = t * 9.25698112229e-2f + -4.94105129971e-1f;
    p = p * t + 8.57169351064e-1f;
    p = p * t + -3.75804416261e-1f;
    p = p * t + 4.60171560075e-1f;
    p = p * t + 2.01009101231e-1f;
    p = p * t + 2.58989723688e-1f;
    const Floats tail = p * t * exp_of(-(a * a));  // erfc(a)
    // 1 + erf is erfc(a) on the left: no cancellation there.
    return 0.5f * x * (x < 0.0f ? tail : 2.0f - tail);
  }
};

/// The last, partial register goes through the same code as the others.
template <class F>
void map(const float* in, float* out, std::int64_t count) {
  std::int64_t i = 0;
  for (; i + kWidth <= count; i += kWidth) store(out + i, F::apply(load(in + i)));
  if (i < count) store_some(out + i, F::apply(load_some(in + i, count - i)), count - i);
}

void add(const float* y, std::int64_t count, float* x) {
  std::int64_t i = 0;
  for (; i + kWidth <= count; i += kWidth) store(x + i, load(x + i) + load(y + i));
  for (; i < count; ++i) x[i] += y[i];
}

void gated_gelu(const float* values, const float* gates, std::int64_t count, float* out) {
  std::int64_t i = 0;
  for (; i + kWidth <= count; i += kWidth) store(out + i, load(values + i) * Gelu::apply(load(gates + i)));
  const std::int64_t rest = count - i;
  if (rest > 0)
    store_some(out + i, load_some(values + i, rest) * Gelu::apply(load_some(gates + i, rest)), rest);
}

inline HalfWords bfloat16_of(Floats x) {
  const Words bits = (Words)x, kept = bits >> 16;
  const Words rounded = (bits + 0x7fffu + (kept & 1u)) >> 16;
  return __builtin_convertvector((bits & 0x7fffffffu) > 0x7f800000u ? (kept | 0x40u) : rounded, HalfWords);
}

void round_to_bfloat16(const float* in, std::uint16_t* out, std::int64_t count) {
  std::int64_t i = 0;
  for (; i + kWidth <= count; i += kWidth) {
    const HalfWords h = bfloat16_of(load(in + i));
    __builtin_memcpy(out + i, &h, sizeof h);
  }
  if (i == count) return;
  const HalfWords h = bfloat16_of(load_some(in + i, count - i));
  for (std::int64_t k = i; k < count; ++k) out[k] = h[k - i];
}

inline Floats gru(Floats ri, Floats zi, Floats ni, Floats rh, Floats zh, Floats nh, Floats h) {
  const Floats r = Sigmoid::apply(ri + rh);
  const Floats z = Sigmoid::apply(zi + zh);
  const Floats n = Tanh::apply(ni + r * nh);
  return n + z * (h - n);
}

void gru_row(const float* gi, const float* gh, const float* h, std::int64_t width, float* out) {
  const float *zi = gi + width, *ni = zi + width, *zh = gh + width, *nh = zh + width;
  std::int64_t i = 0;
  for (; i + kWidth <= width; i += kWidth)
    store(out + i, gru(load(gi + i), load(zi + i), load(ni + i), load(gh + i), load(zh + i), load(nh + i),
                       load(h + i)));
  if (i == width) return;
  float rest[7][kWidth] = {};
  const float* from[7] = {gi, zi, ni, gh, zh, nh, h};
  for (int s = 0; s < 7; ++s)
    for (std::int64_t k = i; k < width; ++k) rest[s][k - i] = from[s][k];
  store(rest[0], gru(load(rest[0]), load(rest[1]), load(rest[2]), load(rest[3]), load(rest[4]), load(rest[5]),
                     load(rest[6])));
  for (std::int64_t k = i; k < width; ++k) out[k] = rest[0][k - i];
}

}  // namespace
}  // namespace mien::elementwise

#include "row_kernel.h"

namespace mien::elementwise {
namespace {

Kernels kernels() {
  return {{map<Exp>, map<Sigmoid>, map<Tanh>, map<Silu>, map<Gelu>, map<Relu>, map<Mish>},
          add,
          gated_gelu,
          layer_norm_row,
          group_norm_rows,
          softmax_row,
          exp_row,
          band_row,
          round_to_bfloat16,
          quantise_row,
          dequantise_row,
          gru_row};
}

}  // namespace
}  // namespace mien::elementwise
