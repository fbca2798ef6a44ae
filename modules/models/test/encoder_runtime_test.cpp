#include "mien/models/speech_encoder/encoder_runtime.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mien/base/hash.h"
#include "mien/base/random.h"
#include "mien/nn/runtime_operations.h"
#include "speech_encoder/fast_convolutions.h"

// The fast path against the network of network.h, on small encoders with random weights.
namespace mien {
namespace {
/// The same weights for a network that runs and one that is packed.
class Fill : public ParameterVisitor<Fill> {
 public:
  void matrix(std::string_view name, Tensor& slot, std::int64_t out, std::int64_t in, Init) {
    slot = weights(name, {out, in}, 0, std::sqrt(3.0 / static_cast<double>(in)));
  }
  void matrix(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in, Init init) {
    Tensor plain;
    matrix(name, plain, out, in, init);
    slot = PackedMatrix(plain);
  }
  void convolution(std::string_view name, Tensor& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init) {
    slot = weights(name, {out, in, kernel}, 0, std::sqrt(6.0 / static_cast<double>(in * kernel)));
  }
  void convolution(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init init) {
    Tensor plain;
    convolution(name, plain, out, in, kernel, init);
    slot = PackedMatrix(tap_major(plain));
  }
  void tensor(std::string_view name, Tensor& slot, const Shape& shape, Init init) {
    slot = weights(name, shape, init == Init::one ? 1 : 0, 0.3);
  }

 private:
  Tensor weights(std::string_view name, const Shape& shape, double offset, double spread) {
    Tensor w(shape);
    Rng rng(hash64(full_name(name)));
    for (float& v : w.values()) v = static_cast<float>(offset + spread * (2 * rng.uniform() - 1));
    return w;
  }
};

template <class T>
SpeechEncoder<T> filled(const EncoderConfig& config) {
  SpeechEncoder<T> encoder(config);
  Fill fill;
  encoder.visit(fill);
  return encoder;
}

EncoderConfig small(bool stable) {
  EncoderConfig c;
  c.hidden_size = 24;
  c.num_hidden_layers = 3;
  c.num_attention_heads = 3;
  c.intermediate_size = 40;
  c.conv_dim = {16, 20, 24, 16, 16, 20, 18};
  c.num_conv_pos_embeddings = stable ? 15 : 16;  // odd kernels drop no frame
  c.num_conv_pos_embedding_groups = 4;
  c.conv_layer_norm = c.conv_bias = c.do_stable_layer_norm = stable;
  return c;
}

std::vector<float> sound(std::size_t count) {
  std::vector<float> s(count);
  NoiseField(3, 0).normal(0, 0, s);
  for (std::size_t i = 1; i < count; ++i) s[i] = 0.9f * s[i - 1] + 0.05f * s[i];
  return s;
}

double largest_difference(const Tensor& a, const Tensor& b) {
  if (a.shape() != b.shape()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (std::size_t i = 0; i < a.values().size(); ++i)
    largest = std::max(largest, std::abs(static_cast<double>(a.values()[i]) - b.values()[i]));
  return largest;
}

class FastEncoder : public testing::TestWithParam<bool> {
 protected:
  EncoderConfig config_ = small(GetParam());
  SpeechEncoder<Tensor> plain_ = filled<Tensor>(config_);
  EncoderRuntime fast_{filled<PlainWeights>(config_)};

  [[nodiscard]] Tensor plain(std::vector<float> samples, std::int64_t num_frames = 0) const {
    if (config_.do_normalize) normalise_waveform(samples, config_.normalise_eps);
    const auto count = static_cast<std::int64_t>(samples.size());
    return plain_(Tensor({count, 1}, samples), {num_frames, {}, {}, {}});
  }
  [[nodiscard]] Tensor fast(std::span<const float> samples, const EncodeOptions& options = {}) const {
    auto h = fast_.encode(samples, options);
    EXPECT_TRUE(h) << h.error().message();
    return h ? std::move(*h) : Tensor();
  }
};
INSTANTIATE_TEST_SUITE_P(Forms, FastEncoder, testing::Values(false, true),
                         [](const auto& form) { return form.param ? "Stable" : "Base"; });

constexpr double kTolerance = 2e-5;  // float32 sums in another order; seen 2e-6

TEST_P(FastEncoder, EqualsTheNetworkForAnyLength) {
  for (const std::size_t length : {400u, 719u, 720u, 721u, 5000u, 21000u, 70001u}) {
    const auto samples = sound(length);
    EXPECT_LT(largest_difference(fast(samples), plain(samples)), kTolerance) << length;
  }
  const std::vector<float> silence(4000, 0.0f), constant(4000, 0.7f);
  EXPECT_LT(largest_difference(fast(silence), plain(silence)), kTolerance);
  EXPECT_LT(largest_difference(fast(constant), plain(constant)), kTolerance);
}

TEST_P(FastEncoder, TakesAnOffsetOutAsTheNormDoes) {
  EncoderConfig raw = config_;
  raw.do_normalize = false;
  auto samples = sound(5000);
  for (float& x : samples) x += 0.2f;
  const auto h = EncoderRuntime(filled<PlainWeights>(raw)).encode(samples);
  ASSERT_TRUE(h);
  EXPECT_LT(largest_difference(*h, filled<Tensor>(raw)(Tensor({5000, 1}, samples))), kTolerance);
}

TEST_P(FastEncoder, InterpolatesToAnyNumberOfFrames) {
  const auto samples = sound(21000);
  for (const std::int64_t frames : {1, 2, 64, 65, 90}) {
    EncodeOptions options;
    options.num_frames = frames;
    EXPECT_LT(largest_difference(fast(samples, options), plain(samples, frames)), kTolerance) << frames;
  }
}

TEST_P(FastEncoder, GivesTheSameBitsOnAnyNumberOfThreads) {
  const auto samples = sound(70001);
  for (const auto precision :
       {EncoderPrecision::float32, EncoderPrecision::bfloat16, EncoderPrecision::int8}) {
    if (!encoder_precision_available(precision)) continue;
    const EncoderRuntime encoder(filled<PlainWeights>(config_), precision);
    const auto one = encoder.encode(samples);
    ASSERT_TRUE(one);
    for (const int threads : {2, 7}) {
      EncodeOptions options;
      options.num_threads = threads;
      const auto more = encoder.encode(samples, options);
      ASSERT_TRUE(more);
      EXPECT_EQ(largest_difference(*one, *more), 0.0) << threads;
    }
    // Rounding shows, and stays small beside values of about 1.
    EXPECT_LT(largest_difference(*one, plain(samples)),
              precision == EncoderPrecision::float32 ? kTolerance : 0.5);
    if (precision != EncoderPrecision::float32) {
      EXPECT_GT(largest_difference(*one, plain(samples)), kTolerance);
    }
  }
}

// Motion answers most to the convolutions and the projection: what they give the first layer has the bits of
// bfloat16 (of float32 on a processor without it).
TEST_P(FastEncoder, InInt8OnlyTheLayersHaveEightBits) {
  if (!encoder_precision_available(EncoderPrecision::int8)) GTEST_SKIP() << "this processor has no int8";
  const auto samples = sound(21000);
  const auto hidden = [&](EncoderPrecision precision) {
    std::vector<Tensor> all;
    EncodeOptions options;
    options.on_hidden = [&](std::int64_t, const Tensor& h) { all.push_back(h); };
    EXPECT_TRUE(EncoderRuntime(filled<PlainWeights>(config_), precision).encode(samples, options));
    return all;
  };
  const auto front = encoder_precision_available(EncoderPrecision::bfloat16) ? EncoderPrecision::bfloat16
                                                                             : EncoderPrecision::float32;
  const auto wide = hidden(front), narrow = hidden(EncoderPrecision::int8);
  ASSERT_EQ(narrow.size(), 4u);
  EXPECT_EQ(largest_difference(narrow[0], wide[0]), 0.0);
  for (std::size_t i = 1; i < narrow.size(); ++i) EXPECT_GT(largest_difference(narrow[i], wide[i]), 0.0) << i;
}

TEST_P(FastEncoder, WindowsWithAllContextAreExact) {
  const auto samples = sound(30000);
  for (const std::int64_t num_frames : {0, 110}) {
    EncodeOptions whole, cut;
    whole.num_frames = cut.num_frames = num_frames;
    cut.windows = {17, 1000, 1000};
    const Tensor exact = fast(samples, whole);
    EXPECT_LT(largest_difference(fast(samples, cut), exact), kTolerance);
    cut.windows = {17, 5, 5};  // and with less they are not, but have as many frames
    const Tensor near = fast(samples, cut);
    EXPECT_EQ(near.shape(), exact.shape());
    EXPECT_GT(largest_difference(near, exact), kTolerance);
  }
  std::vector<std::int64_t> sizes;
  EncodeOptions options;
  options.windows = {40, 10, 10};
  ASSERT_TRUE(fast_.encode(samples, options, [&](const Tensor& h) { sizes.push_back(h.num_rows()); }));
  EXPECT_THAT(sizes, testing::ElementsAre(40, 40, 13));
}

TEST_P(FastEncoder, ShowsHiddenStates) {
  const auto samples = sound(5000);
  std::vector<Tensor> hidden;
  EncodeOptions options;
  options.on_hidden = [&](std::int64_t i, const Tensor& h) {
    EXPECT_EQ(i, static_cast<std::int64_t>(hidden.size()));
    hidden.push_back(h);
  };
  const Tensor last = fast(samples, options);
  ASSERT_EQ(hidden.size(), 4u);
  EXPECT_EQ(largest_difference(hidden.back(), last), 0.0);
  EXPECT_GT(largest_difference(hidden[0], hidden[1]), 0.01);
}

TEST_P(FastEncoder, RefusesSoundThatIsNone) {
  for (const std::size_t length : {0u, 1u, 399u}) {
    const auto h = fast_.encode(sound(length));
    ASSERT_FALSE(h);
    EXPECT_EQ(h.error().code, Errc::input);
    EXPECT_THAT(h.error().message(), testing::HasSubstr("400"));
  }
  auto broken = sound(2000);
  broken[1000] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(fast_.encode(broken));
  EncodeOptions backwards;
  backwards.windows = {-1, 0, 0};
  EXPECT_THROW((void)fast_.encode(sound(2000), backwards), std::logic_error);
}

TEST_P(FastEncoder, ReadsASourceTwiceForTheSameBits) {
  const auto samples = sound(30000);
  for (const EncoderWindows windows : {EncoderWindows{}, {17, 5, 9}, {40, 0, 0}}) {
    EncodeOptions options;
    options.windows = windows;
    const Tensor in_memory = fast(samples, options);
    SamplesInMemory speech(samples);
    const auto heard = fast_.hear(speech);
    ASSERT_TRUE(heard);
    std::vector<float> got;
    ASSERT_TRUE(fast_.encode(speech, *heard, options, [&](const Tensor& h) {
      got.insert(got.end(), h.values().begin(), h.values().end());
    }));
    EXPECT_TRUE(std::ranges::equal(got, in_memory.values()));
    SamplesInMemory shorter{std::span(samples).first(20000)};
    const Status cut = fast_.encode(shorter, *heard, options, [](const Tensor&) {});
    ASSERT_FALSE(cut);
    EXPECT_THAT(cut.error().message(), testing::HasSubstr("became shorter"));
  }
}

TEST(PatchSums, AreThoseOfThePatches) {
  const std::vector<float> samples = {1, 2, 4, 8, 16, 32, 64};  // patches (1 2 4), (4 8 16), (16 32 64)
  for (const std::size_t piece : {1u, 2u, 3u, 7u}) {
    PatchSums sums(3, 2);
    for (std::size_t at = 0; at < samples.size(); at += piece)
      sums.add(std::span(samples).subspan(at, std::min(piece, samples.size() - at)));
    const auto s = sums.statistics();
    EXPECT_THAT(s.mean, testing::ElementsAre(7.0, 14.0, 28.0));
    EXPECT_DOUBLE_EQ(s.covariance[0], (36.0 + 9 + 81) / 3);
    EXPECT_DOUBLE_EQ(s.covariance[1], 2 * s.covariance[0]);
    EXPECT_DOUBLE_EQ(s.covariance[8], 16 * s.covariance[0]);
    EXPECT_DOUBLE_EQ(s.covariance[5], s.covariance[7]);
    PatchSums apart(2, 3);  // (1 2), (8 16): a stride beyond the kernel
    for (std::size_t at = 0; at < samples.size(); at += piece)
      apart.add(std::span(samples).subspan(at, std::min(piece, samples.size() - at)));
    EXPECT_THAT(apart.statistics().mean, testing::ElementsAre(4.5, 9.0));
    EXPECT_EQ(apart.num_samples(), 7);
  }
  PatchSums few(3, 2);
  few.add(std::span(samples).first(2));
  EXPECT_THROW((void)few.statistics(), std::logic_error);
}

TEST(PatchSums, AnOffsetCostsNoPrecision) {
  std::vector<float> samples = sound(50000);
  for (float& x : samples) x = 1000 + 1e-3f * std::round(x * 100);
  PatchSums sums(1, 1);
  sums.add(samples);
  double mean = 0, variance = 0;
  for (const float x : samples) mean += x;
  mean /= static_cast<double>(samples.size());
  for (const float x : samples) variance += (x - mean) * (x - mean);
  variance /= static_cast<double>(samples.size());
  EXPECT_NEAR(sums.statistics().mean[0], mean, 1e-9);
  EXPECT_NEAR(sums.statistics().covariance[0] / variance, 1, 1e-9);
  const std::vector<float> constant(1000, 0.7f);
  PatchSums silent(1, 1);
  silent.add(constant);
  EXPECT_EQ(silent.statistics().covariance[0], 0);
}

}  // namespace
}  // namespace mien
