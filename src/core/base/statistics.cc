#include "core/base/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate {

std::size_t quantile_index(double share, std::size_t count) noexcept {
  const double rank = std::ceil(std::clamp(share, 0.0, 1.0) * static_cast<double>(count));
  return std::clamp<std::size_t>(static_cast<std::size_t>(rank), 1, count) - 1;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(quantile_index(share, values.size()));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double normalized_mad(std::vector<double> residuals) {
  constexpr double kPerMedian = 1.4826;  // for a normal distribution: 1 / (its quantile at 3/4)
  for (double& residual : residuals) residual = std::abs(residual);
  return kPerMedian * median(std::move(residuals));
}

double mean(std::span<const double> values) noexcept {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double standard_deviation(std::span<const double> values) noexcept {
  if (values.size() < 2) return 0.0;
  const double middle = mean(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - middle) * (value - middle);
  return std::sqrt(squares / (static_cast<double>(values.size()) - 1.0));
}

double correlation(std::span<const double> x, std::span<const double> y) noexcept {
  const double mean_x = mean(x);
  const double mean_y = mean(y);
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  const double size = std::sqrt(xx * yy);
  return size > 0.0 ? xy / size : 0.0;
}

double effective_sample_size(std::span<const double> values) noexcept {
  // above this, a few hundred values do not distinguish r from 1
  constexpr double kMaxAutocorrelation = 0.99;
  const double middle = mean(values);
  double squares = 0.0;
  double lagged = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i] - middle;
    squares += value * value;
    if (i > 0) lagged += value * (values[i - 1] - middle);
  }
  const double r = squares > 0.0 ? std::clamp(lagged / squares, 0.0, kMaxAutocorrelation) : 0.0;
  return static_cast<double>(values.size()) * (1.0 - r) / (1.0 + r);
}

}  // namespace palpate
