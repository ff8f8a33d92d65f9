#pragma once
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "palpate/identify.h"

#include "fit/identify/local_optima.h"

namespace palpate::identify {

/// [setup] Central intervals that contain `share` of the points, for each parameter (shared, then own), in SI
/// units.
[[nodiscard]] std::vector<Interval> intervals_of(const std::vector<Point>& points, const Ranges& ranges,
                                                 std::size_t terms, double share = 0.95);

/// [setup] Logarithm of the posterior of a one-part problem, up to a constant. The noise variance is
/// integrated out: a sum of squares S contributes S^(-effective/2). The priors are those of the problem.
/// @param effective effective number of independent points
/// @return -infinity where the parameters are not a valid law
[[nodiscard]] double log_posterior_of(const Problem& problem, const Solution& at, double effective);

/// [setup] Limit of the likelihood-ratio test at 95 %: the square root of the allowed decrease of 2
/// log_posterior_of(). It is the quantile of Student's t for these numbers of points and parameters, times a
/// small margin.
[[nodiscard]] double likelihood_limit(double effective, std::size_t parameters);

/// [setup] Points along the profile likelihood of each parameter [Raue 2009]: one parameter is moved away
/// from the optimum and all others are fitted again, as far as likelihood_limit() allows. Profiles start at
/// each local optimum within that limit that the previous points do not enclose.
[[nodiscard]] std::vector<Point> profile_points(const LocalOptima& optima, double effective,
                                                const std::function<void(double)>& progress);

/// Intervals and correlations from the curvature (the covariance matrix) at the best local optimum.
struct Curvature {
  std::vector<std::optional<Interval>> intervals;  // 95 %; empty for a parameter along which the cost is flat
  std::vector<std::vector<double>> correlations;   // matrix of parameter correlations
};

/// [setup]
[[nodiscard]] Curvature curvature_of(const LocalOptima& optima);

}  // namespace palpate::identify
