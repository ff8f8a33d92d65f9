#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "palpate/identify.h"
#include "run/tasks/communicator.h"

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

/// [any] 97.5 % quantile of Student's t distribution. `freedom` below 3 is treated as 3.
[[nodiscard]] double student_t_quantile(double freedom);

/// [setup] Block bootstrap [Kuensch 1989]: fits `count` resamples of a specimen. A resample is the fitted
/// curve plus its residuals redrawn in blocks; the block length follows from their autocorrelation. Each
/// resample is fitted from the best optima.
/// @param ranks share the resamples and must all make this call; null: this process only
/// @return one point per resample, shared parameters first
[[nodiscard]] std::vector<Point> bootstrap(const LocalOptima& optima, int count, std::uint64_t seed,
                                           std::uint32_t job, const std::function<void(double)>& progress,
                                           tasks::Communicator* ranks = nullptr);

/// [setup] Error of 5-fold cross-validation: RMS residual of the points left out (every fifth point in each
/// fold), divided by the force range.
[[nodiscard]] double cross_validation_error(const LocalOptima& optima);

}  // namespace palpate::identify
