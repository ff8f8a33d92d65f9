#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "science/fit/least_squares.h"

namespace palpate::fit {

/// Points drawn with the probability that the data give them: shared parameters, then own ones.
struct Ensemble {
  std::vector<Point> points;
  std::vector<double> log_posterior;  // of each, up to a constant
  bool settled = false;               // both halves of the run agree
};

/// [setup] ln of the posterior that draw_ensemble() draws from, up to a constant; -infinity out of bounds.
[[nodiscard]] double log_posterior_of(const Problem& problem, const Point& point, double effective);

/// [setup] Draws from the posterior of a problem with one part by differential-evolution Markov chains
/// [ter Braak 2006; ter Braak and Vrugt 2008]: walkers step along the differences of other walkers, so steps
/// have the posterior's own shape, and now and then by a whole difference, so that they cross between minima.
/// The noise's size is integrated out, so a sum of squares S counts S^(-effective/2); the priors are those of
/// the problem, and flat in the logarithms within the bounds.
/// @param minima to begin at, best first, at least one
/// @param effective number of points that count as independent
Ensemble draw_ensemble(const Problem& problem, const std::vector<Solution>& minima, double effective,
                       std::uint64_t seed, std::uint32_t job, const std::function<void(double)>& progress);

}  // namespace palpate::fit
