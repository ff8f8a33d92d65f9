#pragma once
#include <cstddef>
#include <vector>

#include "fit/identify/least_squares.h"

namespace palpate::identify {

/// Local optima of a problem, best first.
struct LocalOptima {
  Problem problem;  // with loss_scale and sigma set from the residuals
  std::vector<Solution> all;
  double effective = 0.0;  // effective number of independent points, from the residuals' autocorrelation
};

/// [setup] Multistart: descends from each start, sets the loss scale from the residuals' median absolute
/// deviation, and descends again from the best few optima.
[[nodiscard]] LocalOptima run_multistart(Problem problem, const std::vector<Solution>& from);

/// [setup] Descends to full convergence at the best optimum, and searches for better ones near it.
void refine_optima(LocalOptima& optima);

/// [setup] run_multistart() from a coarse grid over the parameter space, then refine_optima(). @param more
/// additional starts
[[nodiscard]] LocalOptima find_local_optima(Problem problem, const std::vector<Solution>& more = {});

/// [setup] Descends from additional starts, and searches again when one of them leads to a better optimum.
/// @param optima of one specimen; unchanged unless a better optimum is found
/// @return whether a better optimum was found
[[nodiscard]] bool try_more_starts(LocalOptima& optima, const std::vector<Solution>& from);

/// [setup] Sets the loss scale and sigma from the residuals of the best solution.
void set_loss(Problem& problem, Solution best);

/// [setup] Residuals of a part's points divided by its force range, without loss and weights. Sorted by time;
/// without times, by displacement.
[[nodiscard]] std::vector<double> plain_residuals(const Problem& problem, const Part& part,
                                                  const Point& shared, const Point& own);

/// [setup] Sum over the parts of the effective sample size of the residuals.
[[nodiscard]] double effective_at(const Problem& problem, const Solution& solution);

/// [setup] A point of a problem with one part (shared parameters, then own ones) as a solution with its cost.
[[nodiscard]] Solution solution_at(const Problem& problem, const Point& point);

/// [any] Effective sample size of the residuals, with a lower limit of three points per parameter (if there
/// are that many points). Fewer would give intervals in which the curve visibly does not fit.
[[nodiscard]] double limited_sample_size(double effective, std::size_t points, std::size_t parameters);

/// [setup] Starting points for the multistart: a coarse grid over L_1, q, beta (and relaxation times). For
/// each grid point, k_1 and offset follow from linear least squares. For each L_1 the best `most` starts that
/// are not neighbours are kept, because a coarse grid underrates laws with steep layers. Own parameters start
/// at the middle of their priors.
[[nodiscard]] std::vector<Solution> multistart_points(const Problem& problem, std::size_t most);

/// [setup] Starting points with one law parameter fixed at `value` [natural logarithm of SI] and the given
/// relaxation: the best `most` that are not neighbours. @param held index of the fixed parameter
[[nodiscard]] std::vector<Solution> multistart_points_at(const Problem& problem, std::size_t held,
                                                         double value, const Point& relaxation,
                                                         std::size_t most);

}  // namespace palpate::identify
