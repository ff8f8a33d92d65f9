#pragma once
#include <cstddef>
#include <vector>

#include "science/identify/least_squares.h"

namespace palpate::identify {

/// The minima of a problem, best first, with the loss and the sigma that its residuals call for.
struct Minima {
  Problem problem;  // with loss_scale and sigma as found
  std::vector<Solution> all;
  double effective = 0.0;  // points that count as independent, from how residuals follow their neighbours
};

/// [setup] Descends from starts, sets the loss by the residuals' own spread (half of them lie within 0.6745
/// of it, so that outliers do not count), and descends again from the best few.
[[nodiscard]] Minima search_minima(Problem problem, const std::vector<Solution>& from);

/// [setup] Goes to the very bottom of the best minimum, and looks for better ones beside it.
void settle_minima(Minima& minima);

/// [setup] Both, from a coarse search over all that a tissue may be. @param more starts to descend from
/// besides
[[nodiscard]] Minima find_minima(Problem problem, const std::vector<Solution>& more = {});

/// [setup] Descends from more places, which a wider search found to be as good as the best minimum or better,
/// and looks again for minima where that leads below it.
/// @param minima of one specimen; left as they are unless a better one is found
/// @return whether one was
[[nodiscard]] bool descend_further(Minima& minima, const std::vector<Solution>& from);

/// [setup] Sets the loss and sigma of a problem by what a solution leaves, its best one.
void set_loss(Problem& problem, Solution best);

/// [setup] Residuals of a part's points in shares of its range of force, without loss and weights; in order
/// of time, or without times of displacement.
[[nodiscard]] std::vector<double> plain_residuals(const Problem& problem, const Part& part,
                                                  const Point& shared, const Point& own);

/// [any] The effective sample size of residuals, but at least three a parameter where there are so many
/// points: fewer would let intervals wander where the curve plainly is not.
[[nodiscard]] double trusted_count(double effective, std::size_t points, std::size_t parameters);

}  // namespace palpate::identify
