#pragma once
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "palpate/fit.h"
#include "science/fit/ensemble.h"
#include "science/fit/minima.h"

namespace palpate::fit {

/// [setup] 95 % intervals of every parameter from points of a specimen (shared, then own), in SI.
[[nodiscard]] std::vector<Interval> intervals_of(const std::vector<Point>& points, const Ranges& ranges,
                                                 std::size_t terms);

/// [setup] The points that are nearly as likely as the best: those that a likelihood-ratio test of one
/// parameter at 95 % leaves, by Student's t for what `effective` points tell of as many parameters as a point
/// has.
[[nodiscard]] std::vector<Point> nearly_best(const Ensemble& ensemble, double effective);

/// [setup] Points along the profiles of k_1, beta, q, L_1, first contact and offset: each moved away from the
/// best fit, all others fitted again, as far as a likelihood-ratio test at 95 % leaves. They find the far end
/// of a narrow bent valley that an ensemble hardly enters. From every minimum that the same test leaves.
[[nodiscard]] std::vector<Point> profile_points(const Minima& minima, double effective,
                                                const std::function<void(double)>& progress);

/// [setup] 95 % intervals from the curvature at the best minimum; a parameter along which the cost is flat
/// has none.
[[nodiscard]] std::vector<std::optional<Interval>> covariance_intervals(const Minima& minima);

/// [setup] Correlation of every two parameters over the points, rows and columns in their order; 0 for one
/// that never changes.
[[nodiscard]] std::vector<std::vector<double>> correlations(const std::vector<Point>& points);

}  // namespace palpate::fit
