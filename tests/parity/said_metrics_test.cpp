// Distances between motions against what the programs of SAiD's authors computed.
#include <gtest/gtest.h>

#include "closeness.h"
#include "fixture.h"
#include "mien/metrics/beat_consistency.h"
#include "mien/metrics/multimodality.h"
#include "mien/metrics/wind.h"

namespace mien::parity {
namespace {

using Values = std::vector<double>;

class SaidMetrics : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(fixture_root() / "said/metrics.safetensors"))
      GTEST_SKIP() << "no recorded said/metrics.safetensors in " << fixture_root();
    recorded_.emplace("said", "metrics.safetensors");
  }
  [[nodiscard]] FeatureTable table(const std::string& name) const {
    return {recorded_->file().find(name)->shape.back(), recorded_->doubles(name)};
  }
  // Rows i of [k, ...] as Gaussians.
  [[nodiscard]] GaussianMixture mixture(const std::string& number) const {
    const FeatureTable means = table("wind.mu" + number), covariances = table("wind.cov" + number);
    const auto size = static_cast<std::size_t>(means.width * means.width);
    GaussianMixture m{recorded_->doubles("wind.w" + number), {}};
    for (std::int64_t k = 0; k < means.num_rows(); ++k) {
      const auto mean = means.row(k);
      const auto from =
          covariances.values.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(k) * size);
      m.components.push_back({{mean.begin(), mean.end()}, {from, from + static_cast<std::ptrdiff_t>(size)}});
    }
    return m;
  }
  std::optional<Fixture> recorded_;
};

TEST_F(SaidMetrics, FrechetDistance) {
  const Gaussian x = gaussian_of(table("fd.x")), y = gaussian_of(table("fd.y"));
  MIEN_EXPECT_CLOSE(x.mean, recorded_->doubles("fd.mean_x"), "said metric");
  MIEN_EXPECT_CLOSE(x.covariance, recorded_->doubles("fd.cov_x"), "said metric");
  MIEN_EXPECT_CLOSE(y.mean, recorded_->doubles("fd.mean_y"), "said metric");
  MIEN_EXPECT_CLOSE(y.covariance, recorded_->doubles("fd.cov_y"), "said metric");
  MIEN_EXPECT_CLOSE(Values{frechet_distance(x, y)}, recorded_->doubles("fd.value"), "said metric");
  const Gaussian flat = gaussian_of(table("fd_rank_deficient.x"));
  MIEN_EXPECT_CLOSE(Values{frechet_distance(flat, y)}, recorded_->doubles("fd_rank_deficient.value_exact"),
                    "said metric of few samples");
}

TEST_F(SaidMetrics, DistanceOfMixtures) {
  const MixtureDistance got = mixture_distance(mixture("1"), mixture("2"));
  MIEN_EXPECT_CLOSE(got.cost, recorded_->doubles("wind.distance"), "said metric");
  MIEN_EXPECT_CLOSE(got.plan, recorded_->doubles("wind.plan"), "said plan");
  MIEN_EXPECT_CLOSE(Values{got.value}, recorded_->doubles("wind.value"), "said metric");
}

TEST_F(SaidMetrics, MultimodalityOfRepetitions) {
  Multimodality pairs;
  pairs.add_pairs(table("multimodality.a"), table("multimodality.b"));
  MIEN_EXPECT_CLOSE(Values{pairs.value()}, recorded_->doubles("multimodality.value"), "said metric");

  const auto& shape = recorded_->file().find("multimodality_groups.latents")->shape;
  const FeatureTable all = table("multimodality_groups.latents");
  Multimodality groups;
  for (std::int64_t g = 0; g < shape.at(0); ++g) {
    FeatureTable group{all.width, {}};
    for (std::int64_t r = 0; r < shape.at(1); ++r) {
      const auto row = all.row(g * shape.at(1) + r);
      group.values.insert(group.values.end(), row.begin(), row.end());
    }
    groups.add_group(group);
  }
  MIEN_EXPECT_CLOSE(Values{groups.value()}, recorded_->doubles("multimodality_groups.value"), "said metric");
}

TEST_F(SaidMetrics, BeatConsistency) {
  const auto settings = nlohmann::json::parse(recorded_->metadata("beat"));
  std::vector<BeatSequence> sequences;
  for (std::size_t i = 0; recorded_->has("beat.coeffs" + std::to_string(i)); ++i)
    sequences.push_back({recorded_->doubles("beat.audio_beats" + std::to_string(i)),
                         table("beat.coeffs" + std::to_string(i))});
  ASSERT_FALSE(sequences.empty());
  const double got =
      beat_consistency(sequences, {settings.at("fps").get<double>(), settings.at("threshold").get<double>(),
                                   settings.at("sigma").get<double>()});
  MIEN_EXPECT_CLOSE(Values{got}, recorded_->doubles("beat.score"), "said metric");
}

}  // namespace
}  // namespace mien::parity
