#pragma once
#include <optional>
#include <span>
#include <vector>

#include "palpate/fit/fit.h"
#include "palpate/fit/minima.h"

namespace palpate::fit {

/// [setup] The smallest value that at least that share of `values` do not exceed; `values` must not be empty.
[[nodiscard]] double quantile(std::vector<double> values, double share);

/// [setup] 95 % intervals of every parameter from points of a specimen (shared, then own), in SI.
[[nodiscard]] std::vector<Interval> intervals_of(const std::vector<Point>& points, const Ranges& ranges,
                                                 std::size_t terms);

/// [setup] 95 % intervals from the curvature at the best minimum; a parameter along which the cost is flat
/// has none.
[[nodiscard]] std::vector<std::optional<Interval>> covariance_intervals(const Minima& minima);

/// [setup] Correlation of every two parameters over the points, rows and columns in their order; 0 for one
/// that never changes.
[[nodiscard]] std::vector<std::vector<double>> correlations(const std::vector<Point>& points);

}  // namespace palpate::fit
