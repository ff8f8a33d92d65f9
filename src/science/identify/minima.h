#pragma once
#include <cstddef>
#include <vector>

#include "science/identify/least_squares.h"

namespace palpate::identify {

/// Local optima of a problem, best first.
struct Minima {
  Problem problem;  // with loss_scale and sigma set from the residuals
  std::vector<Solution> all;
  double effective = 0.0;  // effective number of independent points, from the residuals' autocorrelation
};

/// [setup] Multistart: descends from each start, sets the loss scale from the residuals' median absolute
/// deviation, and descends again from the best few optima.
[[nodiscard]] Minima search_minima(Problem problem, const std::vector<Solution>& from);

/// [setup] Descends to full convergence at the best optimum, and searches for better ones near it.
void settle_minima(Minima& minima);

/// [setup] search_minima() from a coarse grid over the parameter space, then settle_minima(). @param more
/// additional starts
[[nodiscard]] Minima find_minima(Problem problem, const std::vector<Solution>& more = {});

/// [setup] Descends from additional starts, and searches again when one of them leads to a better optimum.
/// @param minima of one specimen; unchanged unless a better optimum is found
/// @return whether a better optimum was found
[[nodiscard]] bool descend_further(Minima& minima, const std::vector<Solution>& from);

/// [setup] Sets the loss scale and sigma from the residuals of the best solution.
void set_loss(Problem& problem, Solution best);

/// [setup] Residuals of a part's points divided by its force range, without loss and weights. Sorted by time;
/// without times, by displacement.
[[nodiscard]] std::vector<double> plain_residuals(const Problem& problem, const Part& part,
                                                  const Point& shared, const Point& own);

/// [any] Effective sample size of the residuals, with a lower limit of three points per parameter (if there
/// are that many points). Fewer would give intervals in which the curve visibly does not fit.
[[nodiscard]] double trusted_count(double effective, std::size_t points, std::size_t parameters);

}  // namespace palpate::identify
