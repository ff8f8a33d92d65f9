#include "fit/identify/local_optima.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/portable_math.h"
#include "core/base/statistics.h"

#include "fit/identify/profile_path.h"

namespace palpate::identify {
namespace {

constexpr std::size_t kStarts = 4;  // per value of L_1
constexpr std::size_t kKept = 8;    // optima that are refined with the loss
constexpr double kGain = 1e-3;      // relative decrease of the sum of squares that justifies another round

/// Sorts relaxation terms by time, as values_of() does; the cost does not depend on the order.
void order_terms(Solution& solution) {
  Point& shared = solution.shared;
  for (std::size_t last = shared.size(); last > kLawParameters + 2; last -= 2) {
    for (std::size_t i = kLawParameters; i + 2 < last; i += 2) {
      if (!(shared[i + 1] > shared[i + 3])) continue;
      std::swap(shared[i], shared[i + 2]);
      std::swap(shared[i + 1], shared[i + 3]);
    }
  }
}

void sort_by_cost(std::vector<Solution>& all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Solution& a, const Solution& b) { return a.cost < b.cost; });
}

/// The best `most` solutions without duplicates.
std::vector<Solution> distinct(std::vector<Solution> all, std::size_t most) {
  constexpr double kSame = 0.03;
  constexpr double kSameCost = 1e-6;
  for (Solution& solution : all) order_terms(solution);
  sort_by_cost(all);
  std::vector<Solution> kept;
  for (Solution& solution : all) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&solution](const Solution& other) {
      const bool as_good = solution.cost - other.cost < kSameCost * other.cost;
      if (as_good) return true;  // differ only along directions that the data do not determine
      double distance = 0.0;
      for (std::size_t i = 0; i < solution.shared.size(); ++i) {
        distance = std::max(distance, std::abs(solution.shared[i] - other.shared[i]));
      }
      return distance < kSame;
    });
    if (!known && std::isfinite(solution.cost)) kept.push_back(std::move(solution));
    if (kept.size() == most) break;
  }
  return kept;
}

/// Effort of a search: with relaxation there are many points and each evaluation is expensive.
struct Effort {
  std::size_t descended = 20;  // number of starts that are descended from until convergence
  int steps = 60;              // most iterations of a descent
};

Effort effort_for(const Problem& problem) { return problem.terms == 0 ? Effort{} : Effort{10, 30}; }

std::vector<Solution> descend(const Problem& problem, const std::vector<Solution>& from, int most) {
  constexpr int kNoneHeld = -1;
  constexpr double kTolerance = 1e-6;  // relative, of the sum of squares: the best is refined later
  std::vector<Solution> reached;
  for (const Solution& start : from) reached.push_back(solve(problem, start, most, kNoneHeld, kTolerance));
  return reached;
}

/// Starts near an optimum that a global search can miss: laws with its first two layers merged into one, or
/// its first layer split in two; the rest of the curve is unchanged.
std::vector<Solution> neighbours(const Problem& problem, const Solution& minimum) {
  const Point& at = minimum.shared;                                // ln k_1, ln beta, ln q, ln L_1
  const double step = portable::log(4.0) + portable::exp(-at[1]);  // ln(k_2/k_1)
  const double softer = portable::exp(-step);
  const double length =
      portable::log(portable::exp(at[2]) + softer);  // logarithm of the ratio of a layer's length to that of
                                                     // the layer split off it
  std::vector<Solution> all;
  for (const double way : {-1.0, 1.0}) {
    Solution moved = minimum;
    moved.shared[0] += way * step;
    moved.shared[3] += way * length;
    // the softer layer begins earlier, so that the curve beyond it is unchanged
    const double earlier = portable::exp(way > 0.0 ? at[3] : moved.shared[3]) * (1.0 - softer);
    for (std::size_t p = 0; p < moved.own.size(); ++p) {
      moved.own[p][0] += way * earlier / problem.parts[p].ranges.displacement;
    }
    all.push_back(solve(problem, moved));
  }
  return all;
}

/// Normalised median absolute deviation of all residuals of a solution.
double residual_mad(const Problem& problem, const Solution& solution) {
  std::vector<double> all;
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    const std::vector<double> values =
        plain_residuals(problem, problem.parts[p], solution.shared, solution.own[p]);
    all.insert(all.end(), values.begin(), values.end());
  }
  return std::max(normalized_mad(std::move(all)), kSmallestSigma);
}

/// Standard deviation of the noise, from the squares after the loss.
double sigma_of(const Problem& problem, const Solution& solution) {
  std::size_t points = 0;
  for (const Part& part : problem.parts) points += part.specimen->size();
  const std::size_t parameters = solution.shared.size() + kOwnParameters * problem.parts.size();
  const std::size_t freedom = points > parameters ? points - parameters : 1;
  return std::max(std::sqrt(solution.cost / static_cast<double>(freedom)), kSmallestSigma);
}

/// Refines an optimum to convergence, and sets the loss scale and sigma from its residuals. Sigma weights the
/// priors, and many outliers widen the loss, so this repeats until both are constant.
void refine_optimum(Problem& problem, Solution& best) {
  constexpr int kMaxRounds = 10;
  constexpr int kSteps = 400;  // many, for a narrow optimum where parameters are hardly determined
  constexpr double kSame = 0.8;
  for (int round = 0; round < kMaxRounds; ++round) {
    best = solve(problem, best, kSteps);
    const double sigma = sigma_of(problem, best);
    const double loss_scale = kLoss * residual_mad(problem, best);
    const bool settled = sigma > kSame * problem.sigma && loss_scale > kSame * problem.loss_scale;
    problem.sigma = sigma;
    if (settled) return;
    problem.loss_scale = loss_scale;
  }
}

/// The best solution near an optimum, from short steps along each parameter of the law. For a law with
/// corners the cost has a kink wherever a corner passes a data point, hence many local optima close together;
/// a descent finds only the nearest.
Solution best_nearby(const Problem& problem, const Solution& from) {
  constexpr int kMaxRounds = 6;
  constexpr double kStep = 0.05;                 // logarithm: about the spacing of data points
  const int steps = problem.terms == 0 ? 4 : 1;  // with relaxation each step is expensive
  Solution best = from;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Solution centre = best;
    for (std::size_t index = 0; index < kLawParameters; ++index) {
      for (const double step : {-kStep, kStep}) {
        Solution at = centre;
        for (int n = 0; n < steps; ++n) {
          at = profile_step(problem, at, index, step);
          Solution found = descend(problem, {at}, effort_for(problem).steps).front();
          if (found.cost < best.cost) best = std::move(found);
        }
      }
    }
    if (!(best.cost < (1.0 - kGain) * centre.cost)) break;
  }
  return best;
}

/// The best local optima that the starts lead to, and those near the best one.
std::vector<Solution> search(const Problem& problem, const std::vector<Solution>& from) {
  constexpr int kFirstSteps = 10;
  const Effort effort = effort_for(problem);
  const std::vector<Solution> near = distinct(descend(problem, from, kFirstSteps), effort.descended);
  std::vector<Solution> found = distinct(descend(problem, near, effort.steps), kKept);
  if (found.empty()) return found;
  const std::vector<Solution> beside = neighbours(problem, found.front());
  found.insert(found.end(), beside.begin(), beside.end());
  return distinct(std::move(found), kKept);
}

/// Sets the loss from the best optimum, refines all optima with it, and searches near the best one, until
/// that does not change.
void settle(Problem& problem, std::vector<Solution>& found) {
  constexpr int kMaxRounds = 3;
  for (int round = 0; round < kMaxRounds; ++round) {
    refine_optimum(problem, found.front());
    const double polished = found.front().cost;
    if (!std::isfinite(polished) || problem.parts.size() > 1) return;  // only for one specimen
    for (Solution& other : neighbours(problem, found.front())) found.push_back(std::move(other));
    found.insert(found.begin(), best_nearby(problem, found.front()));
    found = distinct(descend(problem, found, effort_for(problem).steps), kKept);
    if (!(found.front().cost < (1.0 - kGain) * polished)) return;
  }
}

/// A solution to continue with when no start gives a valid law.
Solution at_lowest(const Problem& problem) {
  Solution lowest;
  lowest.shared = problem.bounds.low;
  for (const Part& part : problem.parts) lowest.own.push_back({part.prior.first_contact, part.prior.offset});
  lowest.cost = cost_of(problem, lowest.shared, lowest.own);
  return lowest;
}

/// Largest absolute residual, divided by its part's force range.
double farthest(const Problem& problem, const Solution& solution) {
  double largest = 0.0;
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    for (const double r : plain_residuals(problem, problem.parts[p], solution.shared, solution.own[p])) {
      largest = std::max(largest, std::abs(r));
    }
  }
  return largest;
}

}  // namespace

void set_loss(Problem& problem, Solution best) {
  constexpr int kRounds = 3;  // the weight of the priors depends on sigma
  problem.loss_scale = kLoss * residual_mad(problem, best);
  for (int round = 0; round < kRounds; ++round) {
    best.cost = cost_of(problem, best.shared, best.own);
    problem.sigma = sigma_of(problem, best);
  }
}

std::vector<double> plain_residuals(const Problem& problem, const Part& part, const Point& shared,
                                    const Point& own) {
  const Specimen& specimen = *part.specimen;
  std::vector<double> force(specimen.size());
  predict(specimen, part.ranges, problem.settings, shared, own, force);
  std::vector<std::size_t> order(specimen.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (specimen.time.empty()) {
    std::stable_sort(order.begin(), order.end(), [&specimen](std::size_t a, std::size_t b) {
      return specimen.displacement[a] < specimen.displacement[b];
    });
  }
  std::vector<double> values;
  for (const std::size_t i : order) values.push_back((force[i] - specimen.force[i]) / part.ranges.force);
  return values;
}

double effective_at(const Problem& problem, const Solution& solution) {
  double effective = 0.0;
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    effective +=
        effective_sample_size(plain_residuals(problem, problem.parts[p], solution.shared, solution.own[p]));
  }
  return effective;
}

Solution solution_at(const Problem& problem, const Point& point) {
  const auto own = point.end() - static_cast<std::ptrdiff_t>(kOwnParameters);
  Solution solution{Point(point.begin(), own), {Point(own, point.end())}};
  solution.cost = cost_of(problem, solution.shared, solution.own);
  return solution;
}

double limited_sample_size(double effective, std::size_t points, std::size_t parameters) {
  const double fewest = std::min(static_cast<double>(points), 3.0 * static_cast<double>(parameters));
  return std::max(effective, fewest);
}

LocalOptima run_multistart(Problem problem, const std::vector<Solution>& from) {
  std::vector<Solution> found = search(problem, from);
  if (found.empty()) found = {at_lowest(problem)};
  for (int round = 0; round < 2; ++round) {
    problem.loss_scale = kLoss * residual_mad(problem, found.front());
    problem.sigma = sigma_of(problem, found.front());
    // Outliers may have misled the search without a loss.
    if (round == 0 && farthest(problem, found.front()) > 2.0 * problem.loss_scale) {
      const std::vector<Solution> again = search(problem, from);
      found.insert(found.end(), again.begin(), again.end());
    }
    found = distinct(descend(problem, found, effort_for(problem).steps), kKept);
    if (found.empty()) found = {at_lowest(problem)};
  }
  const double effective = effective_at(problem, found.front());
  return {std::move(problem), std::move(found), effective};
}

void refine_optima(LocalOptima& optima) {
  settle(optima.problem, optima.all);
  optima.effective = effective_at(optima.problem, optima.all.front());
}

LocalOptima find_local_optima(Problem problem, const std::vector<Solution>& more) {
  std::vector<Solution> from = multistart_points(problem, kStarts);
  from.insert(from.begin(), more.begin(), more.end());
  LocalOptima optima = run_multistart(std::move(problem), from);
  refine_optima(optima);
  return optima;
}

bool try_more_starts(LocalOptima& optima, const std::vector<Solution>& from) {
  std::vector<Solution> found = descend(optima.problem, from, effort_for(optima.problem).steps);
  found.insert(found.end(), optima.all.begin(), optima.all.end());
  found = distinct(std::move(found), kKept);
  if (!(found.front().cost < (1.0 - kGain) * optima.all.front().cost)) return false;
  optima.all = std::move(found);
  refine_optima(optima);
  return true;
}

}  // namespace palpate::identify
