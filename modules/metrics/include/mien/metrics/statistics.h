#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace mien {

/// All of these work in double and return NaN where the quantity is not defined (no values, no variance), so
/// that a table can say so instead of showing a made-up zero.

double mean(std::span<const double> values);

/// Percentile p in 0 ... 100 with linear interpolation between the order statistics at position (n - 1) p /
/// 100.
double percentile(std::vector<double> values, double p);
double median(std::vector<double> values);
/// Median of |value - median|.
double median_absolute_deviation(const std::vector<double>& values);

/// Correlation of two series of equal length. NaN when either is constant.
double pearson(std::span<const double> a, std::span<const double> b);

/// Average of correlations by Fisher's z = atanh(r), weighted; NaN entries and entries without weight are
/// left out.
double fisher_mean(std::span<const double> r, std::span<const double> weights);

/// Kolmogorov-Smirnov distance: largest difference of the two empirical distribution functions, 0 ... 1.
double ks_distance(std::vector<double> a, std::vector<double> b);

/// Convolution with a Gaussian of `sigma` samples cut at 2 radius + 1 taps and normalised; the end values
/// repeat.
std::vector<double> smooth_gaussian(std::span<const double> values, double sigma, int radius);

}  // namespace mien
