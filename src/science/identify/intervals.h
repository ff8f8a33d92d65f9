#pragma once
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "palpate/identify.h"
#include "science/identify/minima.h"

namespace palpate::identify {

/// [setup] Intervals of every parameter that hold all but 5 % of the points of a specimen (shared, then own),
/// or all with `share` 1; in SI.
[[nodiscard]] std::vector<Interval> intervals_of(const std::vector<Point>& points, const Ranges& ranges,
                                                 std::size_t terms, double share = 0.95);

/// [setup] ln of the posterior of a problem with one part, up to a constant: the noise's size is integrated
/// out, so a sum of squares S counts S^(-effective/2), and the priors are the problem's.
/// @param effective number of points that count as independent @return -infinity where there is no law
[[nodiscard]] double log_posterior_of(const Problem& problem, const Solution& at, double effective);

/// [setup] The root of twice the fall of log_posterior_of() that a test at 95 % allows: Student's t for what
/// so many points tell of so many parameters, a little wider.
[[nodiscard]] double likelihood_limit(double effective, std::size_t parameters);

/// [setup] Points along the profile likelihood of every parameter [Raue 2009]: each moved away from the best
/// fit, all others fitted again, as far as likelihood_limit() allows, from every minimum that it
/// allows and that the points so far do not enclose.
[[nodiscard]] std::vector<Point> profile_points(const Minima& minima, double effective,
                                                const std::function<void(double)>& progress);

/// What the curvature at the best minimum says.
struct Curvature {
  std::vector<std::optional<Interval>> intervals;  // 95 %; none for a parameter along which the cost is flat
  std::vector<std::vector<double>> correlations;   // of every two parameters, in their order
};

/// [setup]
[[nodiscard]] Curvature curvature_of(const Minima& minima);

}  // namespace palpate::identify
