#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace palpate {

/// [any] Index of the quantile among `count` > 0 sorted values: of the smallest value that at least `share`
/// (0..1) of them do not exceed (nearest rank, definition 1 of [Hyndman and Fan 1996]).
[[nodiscard]] std::size_t quantile_index(double share, std::size_t count) noexcept;

/// [setup] The quantile of values in any order, by nearest rank; 0 without values.
[[nodiscard]] double quantile(std::vector<double> values, double share);

/// [setup] The middle value, the mean of the two middle ones of an even number; 0 without values.
[[nodiscard]] double median(std::vector<double> values);

/// [setup] Normalised median absolute deviation about zero, 1.4826 median|r|: an estimate of the standard
/// deviation of residuals that outliers do not change [Hampel 1974]; 0 without values.
[[nodiscard]] double normalized_mad(std::vector<double> residuals);

/// [any] 0 without values.
[[nodiscard]] double mean(std::span<const double> values) noexcept;

/// [any] Of a sample, with n - 1; 0 of fewer than two values.
[[nodiscard]] double standard_deviation(std::span<const double> values) noexcept;

/// [any] Pearson's correlation of as many x as y; 0 when one of them never changes.
[[nodiscard]] double correlation(std::span<const double> x, std::span<const double> y) noexcept;

/// [any] How many independent values estimate a mean as well as these: n (1 - r) / (1 + r) with their lag-1
/// autocorrelation r, taken as 0 to 0.99 [Bayley and Hammersley 1946].
[[nodiscard]] double effective_sample_size(std::span<const double> values) noexcept;

}  // namespace palpate
