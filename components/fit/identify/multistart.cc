// Where should a fit of the law to measured forces begin? The sum of squares over k_1, beta, q, L_1 and
// the relaxation has several local optima, because layers fill in order and each end of a layer is a
// corner of F(D). One start finds the nearest of them. So a coarse grid is judged first, and its best
// points, spread out, become the starts of the refinement (local_optima.cc).
//
//     grid over L_1, q, beta      times relaxation guesses, or depths of the first contact
//        |    at each point: k_1 and the offset by linear least squares; the cost is what remains.
//        v
//     for each L_1: points near a better one are dropped; the best `most` stay.
//        |
//        v
//     starts, from each value of L_1 -> refined in local_optima.cc -> distinct optima
//
// Three facts keep the grid small:
// - For fixed beta, q, L_1 and relaxation the force is proportional to k_1. So the best k_1 and offset
//   follow from six weighted sums (LineSums), and the grid has one arbitrary k_1 that is scaled
//   afterwards. A point whose best scale is not positive is no start. On a profile that holds k_1 the
//   scale is 1.
// - All values are logarithms: a step of the grid is a factor. L_1 is relative to the deepest measured
//   depth.
// - Only a start has to be right, not an estimate. So all parts share one offset here, the first contact
//   is the mean of its prior or 1.5 deviations beside it, and the prior of the offset counts like 5 % more
//   points that measure 0.
//
// The best of each L_1 are kept, and not the best of all. A coarse grid misses the narrow optimum of a law
// with steep layers, and would give all starts to the broad ones.
//
// Two starts are neighbours when none of their logarithms beta, q, L_1 and relaxation differs by 0.3 or
// more. k_1 does not count, because it follows from the others.
//
// With relaxation every evaluation integrates the history, which is dear. Then the depths of the first
// contact are left out, and the relaxation times are a few spreads over the range that the data resolve:
// from twice the shortest step to half of the duration. multistart_points_at() does all this with one
// parameter held, for a profile of the confidence interval.

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "core/base/portable_math.h"

#include "fit/identify/least_squares.h"
#include "fit/identify/local_optima.h"

namespace palpate::identify {
namespace {

using portable::log;

/// Sums of the linear fit force = scale * shape + offset over all parts, forces divided by the force range.
struct LineSums {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;

  void add(double weight, double shape, double force) {
    n += weight;
    x += weight * shape;
    y += weight * force;
    xx += weight * shape * shape;
    xy += weight * shape * force;
    yy += weight * force * force;
  }
};

/// Sums for a law's forces and the measured ones. All parts share one offset here, which is enough for a
/// start.
LineSums sums_of(const Problem& problem, const Solution& start) {
  LineSums sums;
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    const Part& part = problem.parts[p];
    std::vector<double> force(part.specimen->size());
    const Point own = {start.own[p][0], 0.0};
    predict(*part.specimen, part.ranges, problem.settings, start.shared, own, force);
    for (std::size_t i = 0; i < force.size(); ++i) {
      const double measured = part.specimen->force[i] / part.ranges.force - part.prior.offset;
      sums.add(part.weight[i], force[i] / part.ranges.force, measured);
    }
  }
  return sums;
}

/// Sets the best offset of a start, and the best positive scale of its law unless k_1 is held; sets the cost
/// to the remaining squares. The cost stays infinite where the law is invalid.
void scale_and_judge(const Problem& problem, bool stiffness_held, Solution& start) {
  const LineSums sums = sums_of(problem, start);
  // the prior of the offset acts like additional points that measure 0
  const double held = 0.05 * sums.n;
  const double n = sums.n + held;
  const double spread = sums.xx - sums.x * sums.x / n;
  const double scale = stiffness_held ? 1.0 : (sums.xy - sums.x * sums.y / n) / spread;
  if (!std::isfinite(scale) || !(scale > 0.0)) return;
  const double offset = (sums.y - scale * sums.x) / n;
  start.shared[0] += log(scale);
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    start.own[p][1] = problem.parts[p].prior.offset + offset;
  }
  start.cost = sums.yy - 2.0 * scale * sums.xy + scale * scale * sums.xx - n * offset * offset;
}

/// Initial relaxation: equal weights, times spread over the range that the data resolve.
std::vector<Point> relaxation_guesses(const Problem& problem) {
  if (problem.terms == 0) return {{}};
  const Part& part = problem.parts.front();
  const double longest = log(0.5 * part.ranges.duration);
  const double shortest = log(std::max(2.0 * part.ranges.shortest_step, 1e-4 * part.ranges.duration));
  std::vector<Point> guesses;
  for (const double from : {0.25, 0.5, 0.75}) {
    for (const double to : {0.5, 0.8, 1.0}) {
      if (to <= from && !(problem.terms == 1 && to == 0.5 && from == 0.5)) continue;
      Point guess;
      for (std::size_t i = 0; i < problem.terms; ++i) {
        const double way =
            problem.terms == 1 ? 0.5 : static_cast<double>(i) / static_cast<double>(problem.terms - 1);
        guess.push_back(log(0.8 / static_cast<double>(problem.terms)));
        guess.push_back(shortest + (from + way * (to - from)) * (longest - shortest));
      }
      guesses.push_back(guess);
    }
  }
  return guesses;
}

/// Whether a start is a neighbour of one of `others` in the search grid.
bool is_near(const Solution& start, const std::vector<Solution>& others) {
  constexpr double kApart = 0.3;
  return std::any_of(others.begin(), others.end(), [&start](const Solution& other) {
    double distance = 0.0;
    for (std::size_t i = 1; i < start.shared.size(); ++i) {
      distance = std::max(distance, std::abs(start.shared[i] - other.shared[i]));
    }
    return distance < kApart;
  });
}

/// The best `most` starts that are not neighbours, best first.
std::vector<Solution> best_apart(std::vector<Solution> all, std::size_t most) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Solution& a, const Solution& b) { return a.cost < b.cost; });
  std::vector<Solution> chosen;
  for (const Solution& start : all) {
    if (chosen.size() == most) break;
    if (!is_near(start, chosen)) chosen.push_back(start);
  }
  return chosen;
}

/// Grid of initial parameter values [logarithms].
struct Grid {
  std::vector<double> stiffness, beta, q, limit;
  std::vector<double> contact = {0.0};  // first-contact depth, in standard deviations from the mean of its
                                        // prior
};

std::vector<double> logs(std::initializer_list<double> values, double unit = 1.0) {
  std::vector<double> all;
  for (const double value : values) all.push_back(log(value * unit));
  return all;
}

Grid whole_grid(const Problem& problem) {
  double deepest = 0.0;  // m, measured from first contact
  for (const Part& part : problem.parts) {
    const double way = part.ranges.lowest_displacement + part.ranges.displacement -
                       part.prior.first_contact * part.ranges.displacement;
    deepest = std::max(deepest, way);
  }
  Grid grid;
  grid.stiffness = {log(problem.parts.front().ranges.force / deepest)};  // arbitrary: it is scaled later
  grid.beta = logs({0.5, 1.0, 1.3, 1.7, 2.2, 3.0, 8.0});
  grid.q = logs({0.08, 0.13, 0.2, 0.35, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.3, 1.9, 2.8});
  grid.limit = logs({0.1, 0.17, 0.25, 0.33, 0.37, 0.42, 0.47, 0.52, 0.64, 0.8, 1.1}, deepest);
  if (problem.terms == 0) grid.contact = {0.0, -1.5, 1.5};  // with relaxation each evaluation is expensive
  return grid;
}

/// Adds a start for each grid point with a valid law.
void add_starts(const Problem& problem, const Grid& grid, bool stiffness_held, const Point& relaxation,
                std::vector<Solution>& all) {
  std::vector<Solution> at_contact;
  for (const double spreads : grid.contact) {
    Solution& start = at_contact.emplace_back();
    for (const Part& part : problem.parts) {
      const OwnPrior& prior = part.prior;
      start.own.push_back({prior.first_contact + spreads * prior.first_contact_spread, prior.offset});
    }
  }
  for (const double limit : grid.limit) {
    for (const double q : grid.q) {
      for (const double beta : grid.beta) {
        for (const double stiffness : grid.stiffness) {
          for (Solution start : at_contact) {
            start.shared = {stiffness, beta, q, limit};
            start.shared.insert(start.shared.end(), relaxation.begin(), relaxation.end());
            scale_and_judge(problem, stiffness_held, start);
            if (std::isfinite(start.cost)) all.push_back(std::move(start));
          }
        }
      }
    }
  }
}

}  // namespace

std::vector<Solution> multistart_points(const Problem& problem, std::size_t most) {
  const std::vector<Point> relaxations = relaxation_guesses(problem);
  const Grid whole = whole_grid(problem);
  std::vector<Solution> chosen;
  for (const double limit : whole.limit) {
    Grid grid = whole;
    grid.limit = {limit};
    std::vector<Solution> all;
    for (const Point& relaxation : relaxations) add_starts(problem, grid, false, relaxation, all);
    const std::vector<Solution> best = best_apart(std::move(all), most);
    chosen.insert(chosen.end(), best.begin(), best.end());
  }
  return chosen;
}

std::vector<Solution> multistart_points_at(const Problem& problem, std::size_t held, double value,
                                           const Point& relaxation, std::size_t most) {
  Grid grid = whole_grid(problem);
  *std::array{&grid.stiffness, &grid.beta, &grid.q, &grid.limit}.at(held) = {value};
  std::vector<Solution> all;
  add_starts(problem, grid, held == 0, relaxation, all);
  return best_apart(std::move(all), most);
}

}  // namespace palpate::identify
