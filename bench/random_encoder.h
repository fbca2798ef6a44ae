#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "mien/base/random.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/nn/parameters.h"
#include "mien/nn/plain_weights.h"

namespace mien {

/// Fills a speech encoder with uniform weights of the variance that keeps signals at their size, and norms
/// near one. Weights depend on their order alone, so that every tensor library gets the same.
/// @param make  (shape, values) -> slot
template <class Make>
class FillAtRandom : public ParameterVisitor<FillAtRandom<Make>> {
 public:
  explicit FillAtRandom(Make make) : make_(std::move(make)) {}
  template <class M>
  void matrix(std::string_view, M& slot, std::int64_t out, std::int64_t in, Init) {
    slot = fill({out, in}, 0, std::sqrt(3.0 / static_cast<double>(in)));
  }
  template <class M>
  void convolution(std::string_view, M& slot, std::int64_t out, std::int64_t in, std::int64_t kernel, Init) {
    slot = fill({out, in, kernel}, 0, std::sqrt(6.0 / static_cast<double>(in * kernel)));
  }
  template <class T>
  void tensor(std::string_view name, T& slot, const Shape& shape, Init init) {
    slot = fill(shape, init == Init::one ? 1 : 0, name == "conv.weight_v" ? 1 : 0.125);
  }

 private:
  auto fill(const Shape& shape, double offset, double spread) {
    std::size_t count = 1;
    for (const auto size : shape) count *= static_cast<std::size_t>(size);
    std::vector<float> values(count);
    Rng rng(++seed_);
    for (float& v : values) v = static_cast<float>(offset + spread * (2 * rng.uniform() - 1));
    return make_(shape, values);
  }
  Make make_;
  std::uint64_t seed_ = 0;
};

/// HuBERT-base with such weights.
inline SpeechEncoder<PlainWeights> random_encoder() {
  SpeechEncoder<PlainWeights> weights{EncoderConfig{}};
  FillAtRandom fill([](const Shape& shape, std::vector<float>& values) {
    PlainWeights w(shape);
    std::copy(values.begin(), values.end(), w.values().begin());
    return w;
  });
  weights.visit(fill);
  return weights;
}

/// Noise with the spectrum of speech, roughly. @return samples at 16 kHz
inline std::vector<float> noise_like_speech(double seconds) {
  std::vector<float> s(static_cast<std::size_t>(seconds * 16000));
  NoiseField(1, 0).normal(0, 0, s);
  for (std::size_t i = 1; i < s.size(); ++i) s[i] = 0.9f * s[i - 1] + 0.05f * s[i];
  return s;
}

}  // namespace mien
