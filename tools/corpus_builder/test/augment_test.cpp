#include "augment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "filters.h"

namespace mien {
namespace {

std::vector<float> sine(double hz, double amplitude, std::size_t count) {
  std::vector<float> x(count);
  for (std::size_t i = 0; i < count; ++i)
    x[i] =
        static_cast<float>(amplitude * std::sin(2 * std::numbers::pi * hz * static_cast<double>(i) / 16000));
  return x;
}

double rms(std::span<const float> x) {
  double sum = 0;
  for (const float v : x) sum += static_cast<double>(v) * v;
  return std::sqrt(sum / static_cast<double>(x.size()));
}

double middle_rms(const std::vector<float>& x) {
  return rms(std::span(x).subspan(x.size() / 4, x.size() / 2));
}

TEST(Filters, PassAndStopWhereTheySay) {
  const auto gain = [](double hz, auto filter) {
    auto x = sine(hz, 0.5, 16000);
    const double before = middle_rms(x);
    filter(x);
    return 20 * std::log10(middle_rms(x) / before);
  };
  const auto band = [](std::vector<float>& x) { band_limit(x, 300, 3400); };
  EXPECT_NEAR(gain(1000, band), 0, 0.2);
  EXPECT_NEAR(gain(300, band), -3, 0.3);
  EXPECT_NEAR(gain(3400, band), -3, 0.3);
  EXPECT_LT(gain(100, band), -35);
  const auto low = [](std::vector<float>& x) { x = low_pass(x, 1000); };
  EXPECT_NEAR(gain(1000, low), -3, 0.6);
  EXPECT_NEAR(gain(50, low), 0, 0.1);
  const auto shelf = [](std::vector<float>& x) { high_shelf(x, 1500, 4); };
  EXPECT_NEAR(gain(7000, shelf), 4, 0.5);
  EXPECT_NEAR(gain(100, shelf), 0, 0.1);
}

TEST(Filters, ConvolveEqualsTheSum) {
  Rng rng(3);
  std::vector<float> x(5000), kernel(700);
  for (auto& v : x) v = static_cast<float>(rng.normal());
  for (auto& v : kernel) v = static_cast<float>(rng.normal());
  const auto y = convolve(x, kernel);
  ASSERT_EQ(y.size(), x.size());
  for (const std::size_t n :
       {std::size_t{0}, std::size_t{1}, std::size_t{699}, std::size_t{1400}, std::size_t{4999}}) {
    double sum = 0;
    for (std::size_t k = 0; k < kernel.size() && k <= n; ++k)
      sum += static_cast<double>(kernel[k]) * x[n - k];
    EXPECT_NEAR(y[n], sum, 1e-3) << n;
  }
  EXPECT_TRUE(convolve({}, kernel).empty());
  EXPECT_EQ(convolve(x, {}).size(), x.size());
}

TEST(Filters, ResamplingKeepsTimeAndTremorKeepsLength) {
  std::vector<float> click(22050, 0.0f);
  click[11025] = 1.0f;
  const auto y = resample_audio(click, 22050, 16000);
  ASSERT_EQ(y.size(), 16000u);
  EXPECT_NEAR(static_cast<double>(std::max_element(y.begin(), y.end()) - y.begin()), 8000, 1);
  const auto t = tremor(sine(200, 0.5, 16000), 5, 0.02);
  EXPECT_EQ(t.size(), 16000u);
  EXPECT_NEAR(rms(t), 0.5 / std::sqrt(2.0), 0.01);
  EXPECT_TRUE(tremor({}, 5, 0.02).empty());
}

TEST(Augment, BringsSpeechToItsLevelAndChangesSpeed) {
  AugmentRecipe recipe;
  auto y = augment(sine(300, 0.9, 32000), recipe, {});
  EXPECT_EQ(y.size(), 32000u);
  EXPECT_NEAR(rms(y), 0.06, 0.001);
  recipe.time_factor = 1.16;
  recipe.gain_db = -6;
  y = augment(sine(300, 0.9, 32000), recipe, {});
  EXPECT_EQ(y.size(), 37120u);
  EXPECT_NEAR(rms(y), 0.03, 0.001);
}

TEST(Augment, NoiseHasTheAskedRatio) {
  for (const auto kind : {NoiseKind::white, NoiseKind::brown, NoiseKind::babble}) {
    AugmentRecipe recipe;
    recipe.noise = AddedNoise{kind, 0.9, 3, 10};
    recipe.seed = 5;
    const BabblePool pool = {sine(170, 0.3, 5000), sine(410, 0.3, 7000)};
    const auto clean = augment(sine(300, 0.5, 32000), {}, {});
    auto noisy = augment(sine(300, 0.5, 32000), recipe, pool);
    for (std::size_t i = 0; i < noisy.size(); ++i) noisy[i] -= clean[i];
    EXPECT_NEAR(20 * std::log10(0.06 / rms(noisy)), 10, 0.2);
  }
}

TEST(Augment, ReverberationHasItsTail) {
  AugmentRecipe recipe;
  recipe.reverb = Reverb{0.4, 0.3};
  std::vector<float> click(16000, 0.0f);
  click[100] = 1.0f;
  const auto y = augment(click, recipe, {});
  double tail = 0;
  for (std::size_t i = 100 + 32; i < y.size(); ++i) tail += static_cast<double>(y[i]) * y[i];
  EXPECT_NEAR(tail / (static_cast<double>(y[100]) * y[100]), 0.3, 0.01);
  for (std::size_t i = 101; i < 132; ++i) EXPECT_NEAR(y[i], 0, 1e-6);
}

TEST(Augment, ClippingAndMuLawLimitTheValues) {
  AugmentRecipe recipe;
  recipe.clip_level = 0.05;
  for (const float v : augment(sine(300, 0.5, 8000), recipe, {})) ASSERT_LE(std::abs(v), 0.05f);
  recipe = {};
  recipe.mu_law = true;
  const auto y = augment(sine(300, 0.5, 8000), recipe, {});
  std::set<float> levels(y.begin(), y.end());
  EXPECT_LT(levels.size(), 256u);
  EXPECT_NEAR(rms(y), 0.06, 0.002);
}

TEST(Augment, IsDecidedByTheRecipe) {
  Rng rng(11);
  const auto x = sine(220, 0.4, 16000);
  for (int i = 0; i < 20; ++i) {
    const auto recipe = draw_training_recipe(rng);
    const auto a = augment(x, recipe, {x}), b = augment(x, recipe, {x});
    EXPECT_EQ(a, b);
    EXPECT_TRUE(recipe.noise.has_value()) << "sound without noise must not be trained on";
    for (const float v : a) ASSERT_TRUE(std::isfinite(v));
  }
  int worsened = 0;
  for (int i = 0; i < 2000; ++i) worsened += draw_training_recipe(rng).noise->snr_db < 35 ? 1 : 0;
  EXPECT_NEAR(worsened / 2000.0, 0.85 + 0.15 * 0.25, 0.03);
}

TEST(Augment, SurvivesEmptySilentAndShortSound) {
  Rng rng(2);
  for (int i = 0; i < 10; ++i) {
    const auto recipe = draw_training_recipe(rng);
    EXPECT_TRUE(augment({}, recipe, {}).empty());
    EXPECT_LE(augment(std::vector<float>{0.5f}, recipe, {{}}).size(), 2u);
    for (const float v : augment(std::vector<float>(3000, 0.0f), recipe, {})) ASSERT_TRUE(std::isfinite(v));
  }
}

}  // namespace
}  // namespace mien
