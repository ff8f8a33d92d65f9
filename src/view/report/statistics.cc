#include "view/report/statistics.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include <Eigen/Core>
#include <fmt/core.h>
#include <unsupported/Eigen/FFT>

#include "core/base/normal_distribution.h"
#include "core/base/statistics.h"
#include "palpate/error.h"

namespace palpate::report {
namespace {

/// @param times multiplicity of each value; empty: 1 each
void count_into(Bins& bins, std::span<const double> values, std::span<const std::uint64_t> times = {}) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i];
    if (!(value >= bins.edges.front() && value <= bins.edges.back())) continue;
    const auto above = std::upper_bound(bins.edges.begin(), bins.edges.end(), value);
    const auto index = static_cast<std::size_t>(above - bins.edges.begin());
    bins.counts[std::min(index, bins.counts.size()) - 1] += times.empty() ? 1 : times[i];
  }
}

}  // namespace

Percentiles percentiles(std::vector<std::int64_t> values) {
  Percentiles result;
  result.count = values.size();
  if (values.empty()) return result;
  std::sort(values.begin(), values.end());
  result.p50 = values[quantile_index(0.5, values.size())];
  result.p99 = values[quantile_index(0.99, values.size())];
  result.p999 = values[quantile_index(0.999, values.size())];
  result.max = values.back();
  return result;
}

Bins bin_linear(std::span<const double> values, double low, double high, int number) {
  if (!(low < high) || number <= 0) throw InputError("histogram: want low < high and at least one bin");
  Bins bins;
  bins.counts.assign(static_cast<std::size_t>(number), 0);
  for (int i = 0; i <= number; ++i) bins.edges.push_back(low + (high - low) * i / number);
  count_into(bins, values);
  return bins;
}

Bins bin_logarithmic(std::span<const double> values, int per_decade, std::span<const std::uint64_t> times) {
  if (per_decade <= 0) throw InputError("histogram: want at least one bin a decade");
  if (!times.empty() && times.size() != values.size()) {
    throw InputError(
        fmt::format("histogram: want one count a value, {} for {}", times.size(), values.size()));
  }
  double low = 0.0;
  double high = 0.0;
  for (const double value : values) {
    if (!(value > 0.0) || !std::isfinite(value)) continue;
    low = low > 0.0 ? std::min(low, value) : value;
    high = std::max(high, value);
  }
  Bins bins;
  if (!(low > 0.0)) return bins;
  const int first = static_cast<int>(std::floor(std::log10(low)));
  const int last = std::max(first + 1, static_cast<int>(std::ceil(std::log10(high))));
  bins.counts.assign(static_cast<std::size_t>(last - first) * static_cast<std::size_t>(per_decade), 0);
  for (int i = 0; i <= (last - first) * per_decade; ++i)
    bins.edges.push_back(std::pow(10.0, first + static_cast<double>(i) / per_decade));
  count_into(bins, values, times);
  return bins;
}

Spectrum welch(std::span<const double> samples, double rate, std::size_t segment) {
  if (!std::has_single_bit(segment) || segment < 4) {
    throw InputError(fmt::format("spectrum: segments of {} samples, want a power of two >= 4", segment));
  }
  Spectrum result;
  if (samples.size() < segment) return result;
  std::vector<double> window(segment);
  double power = 0.0;
  for (std::size_t i = 0; i < segment; ++i) {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(segment);
    window[i] = 0.5 - 0.5 * std::cos(phase);
    power += window[i] * window[i];
  }
  const std::size_t half = segment / 2;
  result.density.assign(half + 1, 0.0);
  Eigen::FFT<double> fft;
  std::vector<double> values(segment);
  std::vector<std::complex<double>> frequencies;
  for (std::size_t start = 0; start + segment <= samples.size(); start += half) {
    for (std::size_t i = 0; i < segment; ++i) values[i] = samples[start + i] * window[i];
    fft.fwd(frequencies, values);
    for (std::size_t i = 0; i <= half; ++i) result.density[i] += std::norm(frequencies[i]);
    ++result.segments;
  }
  for (std::size_t i = 0; i <= half; ++i) {
    const double sides = i == 0 || i == half ? 1.0 : 2.0;
    result.density[i] *= sides / (rate * power * static_cast<double>(result.segments));
    result.frequency.push_back(rate * static_cast<double>(i) / static_cast<double>(segment));
  }
  return result;
}

NormalCheck check_standard_normal(std::vector<double> values) {
  NormalCheck result;
  result.count = values.size();
  if (values.empty()) return result;
  std::sort(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  result.mean = mean(values);
  result.standard_deviation = standard_deviation(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double expected = normal_cdf(values[i]);
    const double below = static_cast<double>(i) / count;
    const double up_to = static_cast<double>(i + 1) / count;
    result.ks_distance = std::max({result.ks_distance, expected - below, up_to - expected});
  }
  return result;
}

}  // namespace palpate::report
