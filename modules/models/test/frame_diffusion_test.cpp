// The fast paths of FaceDiffuser against the plain loop.
#include "mien/models/facediffuser/frame_diffusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "random_network.h"

namespace mien::facediffuser {
namespace {

constexpr std::int64_t kFrames = 11, kSteps = 7;
const Sizes kMesh{.variant = Variant::vertices,
                  .num_channels = 90,
                  .latent = 10,
                  .hidden = 10,
                  .num_steps = kSteps,
                  .condition = 24,
                  .num_subjects = 3,
                  .num_taps = 9};
const Sizes kRig{.variant = Variant::beat,
                 .num_channels = 9,
                 .latent = 8,
                 .hidden = 12,
                 .num_steps = kSteps,
                 .condition = 24};

DiffusionProcess process() { return DiffusionProcess(betas_of(BetaSchedule::cosine, kSteps)); }

float largest_difference(const Tensor& a, const Tensor& b) {
  EXPECT_EQ(a.shape(), b.shape());
  float largest = 0;
  for (std::int64_t i = 0; i < std::min(a.count(), b.count()); ++i) {
    const float d = std::abs(a.data()[i] - b.data()[i]);
    largest = std::isnan(d) ? 1e9f : std::max(largest, d);
  }
  return largest;
}

bool same_bits(const Tensor& a, const Tensor& b) {
  return a.shape() == b.shape() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.count()) * sizeof(float)) == 0;
}

template <class Denoiser>
struct Prepared {
  explicit Prepared(const Sizes& sizes)
      : network(std::make_shared<const Denoiser>(random_network(Denoiser(sizes)))),
        folded(std::make_shared<const FoldedDenoiser>(fold(network))),
        speech(random_rows(kFrames, sizes.condition, 5)) {
    given.speech = network->speech_tokens(speech);
    if constexpr (std::is_same_v<Denoiser, VertexDenoiser<Tensor>>) {
      given.style = network->style(Operations<Tensor>::one_hot({}, 1, sizes.num_subjects));
      given.neutral = random_rows(1, sizes.num_channels, 6);
    }
  }
  [[nodiscard]] Lane lane(const FrameNoise& noise, bool is_data) const {
    return {given.style, given.neutral, &noise, is_data};
  }
  /// In blocks of `cuts` frames.
  [[nodiscard]] Tensor fast(const Walk& walk, const Lane& lane,
                            const std::vector<std::int64_t>& cuts = {kFrames}, int num_threads = 1) const {
    FrameDiffusion diffusion(folded, process(), walk, {lane}, num_threads);
    std::vector<Tensor> parts;
    std::int64_t at = 0;
    for (const std::int64_t count : cuts) {
      const Tensor part = rows(speech, at, count);
      parts.push_back(std::move(diffusion.next({&part, 1}).front()));
      at += count;
    }
    return Operations<Tensor>::concat_rows(parts);
  }

  std::shared_ptr<const Denoiser> network;
  std::shared_ptr<const FoldedDenoiser> folded;
  Tensor speech;
  Conditions<Tensor> given;
};

const std::vector<Walk> kWalks = {{},
                                  {.skip = 3},
                                  {.sampler = {.kind = SamplerKind::ddim}},
                                  {.sampler = {.kind = SamplerKind::ddim, .eta = 0.5}, .skip = 1},
                                  {.sampler = {.kind = SamplerKind::dpmpp_2m}}};

template <class Denoiser>
void expect_equal_to_plain(const Sizes& sizes) {
  const Prepared<Denoiser> s(sizes);
  const SeededFrameNoise noise(3, 0, sizes.num_channels);
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    const Tensor plain = sample_plainly(*s.network, s.given, process(), kWalks[i], noise);
    EXPECT_LT(largest_difference(s.fast(kWalks[i], s.lane(noise, true)), plain), 2e-5f) << "walk " << i;
  }
}

TEST(FrameDiffusion, EqualsThePlainLoop) {
  expect_equal_to_plain<VertexDenoiser<Tensor>>(kMesh);
  expect_equal_to_plain<BeatDenoiser<Tensor>>(kRig);
  Sizes damm = kRig;
  damm.variant = Variant::damm;
  damm.hidden = damm.latent;
  damm.decoder.num_layers = 4;
  expect_equal_to_plain<DammDenoiser<Tensor>>(damm);
}

TEST(FrameDiffusion, EqualsThePlainLoopWithFewerChannelsThanLatents) {
  Sizes narrow = kMesh;
  narrow.num_channels = 12;
  expect_equal_to_plain<VertexDenoiser<Tensor>>(narrow);
  const Prepared<VertexDenoiser<Tensor>> s(narrow);
  EXPECT_EQ(s.folded->noise_width, 12);
  // The channels themselves are drawn, so seeded noise is that of the plain loop.
  const SeededFrameNoise noise(3, 0, 12);
  EXPECT_LT(largest_difference(s.fast({}, s.lane(noise, false)),
                               sample_plainly(*s.network, s.given, process(), {}, noise)),
            2e-5f);
}

TEST(FrameDiffusion, ClipsWhereTheStateIsTheData) {
  const Prepared<BeatDenoiser<Tensor>> s(kRig);
  const SeededFrameNoise noise(3, 0, kRig.num_channels);
  Walk clipped;
  clipped.sampler.clip_x0 = {.low = -0.1f, .high = 0.1f};
  const Tensor plain = sample_plainly(*s.network, s.given, process(), clipped, noise);
  EXPECT_LT(largest_difference(s.fast(clipped, s.lane(noise, true)), plain), 2e-5f);
  const Prepared<VertexDenoiser<Tensor>> mesh(kMesh);
  EXPECT_THROW(FrameDiffusion(mesh.folded, process(), clipped, {mesh.lane(noise, true)}), std::logic_error);
}

TEST(FrameDiffusion, GivesTheSameBitsForAnyCutAndThreads) {
  const Prepared<VertexDenoiser<Tensor>> s(kMesh);
  const SeededFrameNoise noise(9, 2, s.folded->noise_width);
  for (const Walk& walk : kWalks) {
    const Tensor whole = s.fast(walk, s.lane(noise, false));
    for (const auto& cuts :
         std::vector<std::vector<std::int64_t>>{std::vector<std::int64_t>(kFrames, 1), {4, 0, 7}, {1, 9, 1}})
      EXPECT_TRUE(same_bits(s.fast(walk, s.lane(noise, false), cuts), whole));
    EXPECT_TRUE(same_bits(s.fast(walk, s.lane(noise, false), {kFrames}, 3), whole));
  }
}

TEST(FrameDiffusion, LanesDoNotMeet) {
  const Prepared<VertexDenoiser<Tensor>> s(kMesh);
  const SeededFrameNoise first(1, 0, s.folded->noise_width), second(2, 0, s.folded->noise_width, true);
  const Tensor other_speech = random_rows(kFrames, kMesh.condition, 77);
  FrameDiffusion both(s.folded, process(), {}, {s.lane(first, false), s.lane(second, false)});
  const Tensor speech[] = {s.speech, other_speech};
  const auto out = both.next(speech);
  EXPECT_TRUE(same_bits(out[0], s.fast({}, s.lane(first, false))));
  FrameDiffusion alone(s.folded, process(), {}, {s.lane(second, false)});
  EXPECT_TRUE(same_bits(out[1], alone.next({&other_speech, 1}).front()));
  EXPECT_FALSE(same_bits(out[0], out[1]));
}

// Noise that is drawn as C xi is noise of the mesh: with z = A^T (A A^T)^-1 C xi the plain loop gives the
// same.
class LiftedNoise final : public FrameNoise {
 public:
  LiftedNoise(const FoldedDenoiser& f, const FrameNoise& latent) : f_(f), latent_(latent) {
    Tensor unit({f.output_width, f.output_width});
    for (std::int64_t i = 0; i < f.output_width; ++i) unit.row(i)[static_cast<std::size_t>(i)] = 1;
    a_transposed_ = f.to_state(unit);
  }
  void start(std::int64_t frame, std::span<float> out) const override {
    Tensor xi({1, f_.noise_width});
    latent_.start(frame, xi.values());
    lift(xi, out);
  }
  void step(int step, std::int64_t frame, std::span<float> out) const override {
    Tensor xi({1, f_.noise_width});
    latent_.step(step, frame, xi.values());
    lift(xi, out);
  }
  /// A A^T, in double.
  [[nodiscard]] std::vector<double> gram() const {
    const std::int64_t n = f_.state_width;
    std::vector<double> g(static_cast<std::size_t>(n * n));
    for (std::int64_t d = 0; d < a_transposed_.num_rows(); ++d)
      for (std::int64_t i = 0; i < n; ++i)
        for (std::int64_t j = 0; j < n; ++j)
          g[static_cast<std::size_t>(i * n + j)] +=
              static_cast<double>(a_transposed_.row(d)[static_cast<std::size_t>(i)]) *
              static_cast<double>(a_transposed_.row(d)[static_cast<std::size_t>(j)]);
    return g;
  }

 private:
  void lift(const Tensor& xi, std::span<float> out) const {
    const std::int64_t n = f_.state_width;
    const Tensor y = linear(xi, f_.noise_map);
    std::vector<double> g = gram(), x(y.values().begin(), y.values().end());
    for (std::int64_t k = 0; k < n; ++k)  // Gauss; A A^T is positive definite
      for (std::int64_t i = k + 1; i < n; ++i) {
        const double factor = g[static_cast<std::size_t>(i * n + k)] / g[static_cast<std::size_t>(k * n + k)];
        for (std::int64_t j = k; j < n; ++j)
          g[static_cast<std::size_t>(i * n + j)] -= factor * g[static_cast<std::size_t>(k * n + j)];
        x[static_cast<std::size_t>(i)] -= factor * x[static_cast<std::size_t>(k)];
      }
    for (std::int64_t i = n; i-- > 0;) {
      for (std::int64_t j = i + 1; j < n; ++j)
        x[static_cast<std::size_t>(i)] -=
            g[static_cast<std::size_t>(i * n + j)] * x[static_cast<std::size_t>(j)];
      x[static_cast<std::size_t>(i)] /= g[static_cast<std::size_t>(i * n + i)];
    }
    for (std::size_t d = 0; d < out.size(); ++d) {
      double sum = 0;
      const auto row = a_transposed_.row(static_cast<std::int64_t>(d));
      for (std::int64_t i = 0; i < n; ++i)
        sum += static_cast<double>(row[static_cast<std::size_t>(i)]) * x[static_cast<std::size_t>(i)];
      out[d] = static_cast<float>(sum);
    }
  }
  const FoldedDenoiser& f_;
  const FrameNoise& latent_;
  Tensor a_transposed_;
};

TEST(FrameDiffusion, LatentNoiseIsNoiseOfTheMesh) {
  const Prepared<VertexDenoiser<Tensor>> s(kMesh);
  const SeededFrameNoise latent(4, 0, s.folded->noise_width);
  const LiftedNoise lifted(*s.folded, latent);
  const Tensor plain = sample_plainly(*s.network, s.given, process(), {}, lifted);
  EXPECT_LT(largest_difference(s.fast({}, s.lane(latent, false)), plain), 5e-5f);
}

TEST(FrameDiffusion, LatentNoiseHasTheCovarianceOfTheMeshs) {
  const Prepared<VertexDenoiser<Tensor>> s(kMesh);
  const SeededFrameNoise latent(4, 0, s.folded->noise_width);
  const std::vector<double> want = LiftedNoise(*s.folded, latent).gram();
  const Tensor c = s.folded->noise_map.unpacked();
  const Tensor got = linear(c, PackedMatrix(c));
  for (std::size_t i = 0; i < want.size(); ++i) ASSERT_NEAR(got.values()[i], want[i], 1e-5);
}

TEST(FrameDiffusion, NoFramesGiveNoFrames) {
  const Prepared<BeatDenoiser<Tensor>> s(kRig);
  const SeededFrameNoise noise(3, 0, kRig.num_channels);
  EXPECT_EQ(s.fast({}, s.lane(noise, false), {0}).shape(), (Shape{0, kRig.num_channels}));
}

}  // namespace
}  // namespace mien::facediffuser
