#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace palpate::report {

/// Percentiles of a set of times [ns]; all 0 when empty.
struct Percentiles {
  std::size_t count = 0;
  std::int64_t p50 = 0;
  std::int64_t p99 = 0;
  std::int64_t p999 = 0;
  std::int64_t max = 0;
};

/// [setup] Exact percentiles: the smallest value that at least that fraction of all values does not exceed.
[[nodiscard]] Percentiles percentiles(std::vector<std::int64_t> values);

/// Histogram: counts[i] values with edges[i] <= value < edges[i+1]; the last bin includes its upper edge.
struct Bins {
  std::vector<double> edges;  // one more than counts
  std::vector<std::size_t> counts;
};

/// [setup] `number` bins of equal width over [low, high]; values outside are ignored. @throws InputError
/// unless low < high and number > 0.
[[nodiscard]] Bins bin_linear(std::span<const double> values, double low, double high, int number);

/// [setup] Logarithmic bins, `per_decade` per factor of ten, from the decade of the smallest value to that of
/// the largest. Values <= 0 are ignored. Empty when there is no positive value.
/// @param times multiplicity of each value; empty: 1 each
/// @throws InputError unless per_decade > 0, and when the number of multiplicities differs from that of the
/// values.
[[nodiscard]] Bins bin_logarithmic(std::span<const double> values, int per_decade,
                                   std::span<const std::uint64_t> times = {});

/// One-sided power spectral density.
struct Spectrum {
  std::vector<double> frequency;  // Hz
  std::vector<double> density;    // unit of the samples squared, per Hz
  std::size_t segments = 0;       // number of segments averaged
};

/// [setup] Welch's method: Hann windows of `segment` samples with an overlap of one half. White noise of
/// variance v has density 2 v / rate. Empty when there are fewer samples than one segment.
/// @param rate sampling rate [Hz] @throws InputError unless `segment` is a power of two and at least 4.
[[nodiscard]] Spectrum welch(std::span<const double> samples, double rate, std::size_t segment);

/// Comparison of a sample with the standard normal distribution.
struct NormalCheck {
  std::size_t count = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;
  double ks_distance = 0.0;  // Kolmogorov-Smirnov statistic: largest distance between the distribution
                             // functions
};

/// [setup] Compares with mean 0 and standard deviation 1; all 0 when empty.
[[nodiscard]] NormalCheck check_standard_normal(std::vector<double> values);

}  // namespace palpate::report
