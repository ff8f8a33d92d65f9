#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace palpate {

/// [any] Index of a quantile among `count` > 0 sorted values by nearest rank (definition 1 of [Hyndman and
/// Fan 1996]): of the smallest value that at least the fraction `share` (0..1) does not exceed.
[[nodiscard]] std::size_t quantile_index(double share, std::size_t count) noexcept;

/// [setup] The quantile of unsorted values, by nearest rank; 0 for no values.
[[nodiscard]] double quantile(std::vector<double> values, double share);

/// [setup] The median: the middle value, or the mean of the two middle ones; 0 for no values.
[[nodiscard]] double median(std::vector<double> values);

/// [setup] Normalized median absolute deviation about zero, 1.4826 median|r|: a robust estimate of the
/// standard deviation of residuals [Hampel 1974]; 0 for no values.
[[nodiscard]] double normalized_mad(std::vector<double> residuals);

/// [any] The mean; 0 for no values.
[[nodiscard]] double mean(std::span<const double> values) noexcept;

/// [any] Standard deviation of a sample, with n - 1; 0 for fewer than two values.
[[nodiscard]] double standard_deviation(std::span<const double> values) noexcept;

/// [any] Pearson's correlation of x and y, of equal size; 0 when one of them is constant.
[[nodiscard]] double correlation(std::span<const double> x, std::span<const double> y) noexcept;

/// [any] Effective sample size of autocorrelated values: n (1 - r) / (1 + r), with their lag-1
/// autocorrelation r limited to 0 to 0.99 [Bayley and Hammersley 1946].
[[nodiscard]] double effective_sample_size(std::span<const double> values) noexcept;

}  // namespace palpate
