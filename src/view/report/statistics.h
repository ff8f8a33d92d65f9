#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace palpate::report {

/// Order statistics of a set of times [ns]; all 0 when empty.
struct Percentiles {
  std::size_t count = 0;
  std::int64_t p50 = 0;
  std::int64_t p99 = 0;
  std::int64_t p999 = 0;
  std::int64_t max = 0;
};

/// [setup] Exact: each is the smallest value that at least that share of all values do not exceed.
[[nodiscard]] Percentiles percentiles(std::vector<std::int64_t> values);

/// Counts of values between edges: counts[i] of edges[i] <= value < edges[i+1]; the last bin takes its upper
/// edge too.
struct Bins {
  std::vector<double> edges;  // one more than counts
  std::vector<std::size_t> counts;
};

/// [setup] `number` bins of equal width over [low, high]; values outside are left out.
/// @throws InputError unless low < high and number > 0.
[[nodiscard]] Bins bin_linear(std::span<const double> values, double low, double high, int number);

/// [setup] Bins of equal ratio, `per_decade` to a factor of ten, from the decade of the smallest to that of
/// the largest value; values <= 0 are left out. Empty when none is left. @param times how often each value
/// was met; empty: once each. @throws InputError unless per_decade > 0, and when there is not one count a
/// value.
[[nodiscard]] Bins bin_logarithmic(std::span<const double> values, int per_decade,
                                   std::span<const std::uint64_t> times = {});

/// One-sided power spectral density.
struct Spectrum {
  std::vector<double> frequency;  // Hz
  std::vector<double> density;    // unit of the samples squared, per Hz
  std::size_t segments = 0;       // averaged
};

/// [setup] Welch's estimate: Hann windows of `segment` samples that overlap by half; a white signal of
/// variance v has density 2 v / rate. Empty when there are fewer samples than one segment. @param rate Hz, of
/// the samples
/// @throws InputError unless `segment` is a power of two and at least 4.
[[nodiscard]] Spectrum welch(std::span<const double> samples, double rate, std::size_t segment);

/// How near a sample is to the standard normal distribution.
struct NormalCheck {
  std::size_t count = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;
  double ks_distance = 0.0;  // Kolmogorov-Smirnov: largest distance between the distribution functions
};

/// [setup] Against mean 0 and standard deviation 1; all 0 when empty.
[[nodiscard]] NormalCheck check_standard_normal(std::vector<double> values);

}  // namespace palpate::report
