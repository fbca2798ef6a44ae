#pragma once
#include <cstdint>
#include <vector>

#include "mien/metrics/gaussian_mixture.h"

namespace mien {

/// The cheapest way to move masses `from` [n] to `to` [m] at `cost` [n, m] for a unit: what goes from i to j,
/// [n, m]. Exact (successive shortest paths). @pre no mass is negative, and both sums are equal
std::vector<double> cheapest_transport(const std::vector<double>& from, const std::vector<double>& to,
                                       const std::vector<double>& cost);

/// Distance of two mixtures: their components are moved onto each other at the cheapest price, which for two
/// components is frechet_distance(): the *squared* Wasserstein-2 distance (the paper says "Wasserstein
/// distance").
struct MixtureDistance {
  std::vector<double> cost, plan;  ///< [n, m]
  double value = 0;                ///< sum of both
};
MixtureDistance mixture_distance(const GaussianMixture& a, const GaussianMixture& b);

/// WInD: mixtures are fitted `num_repeats` times from different starts; mean and standard deviation (divisor
/// n - 1) of their distances. NaN where a mixture cannot be fitted.
struct WindScore {
  double mean = 0, deviation = 0;
};
struct WindOptions {
  MixtureOptions mixture{};
  int num_repeats = 10;  ///< as in the authors' program, which ignores its own argument
  int num_threads = 1;   ///< the result does not depend on it
};
WindScore wind(const FeatureTable& a, const FeatureTable& b, const WindOptions& options = {});

}  // namespace mien
