#include "palpate/fit/starts.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "palpate/base/portable_math.h"
#include "palpate/fit/forward.h"

namespace palpate::fit {
namespace {

using portable::log;

/// Sums of a straight-line fit force = scale x shape + offset over all parts, forces in shares of ranges.
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

/// The best positive scale of a law whose k_1 is `shared`'s, and what is left. One offset stands for those of
/// all parts: good enough to start from.
void scale_and_judge(const Problem& problem, Solution& start) {
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
  // the offset is held back by its prior, as if some points had measured it as 0
  const double held = 0.05 * sums.n;
  const double n = sums.n + held;
  const double spread = sums.xx - sums.x * sums.x / n;
  const double scale = (sums.xy - sums.x * sums.y / n) / spread;
  if (!std::isfinite(scale) || !(scale > 0.0)) return;
  const double offset = (sums.y - scale * sums.x) / n;
  start.shared[0] += log(scale);
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    start.own[p][1] = problem.parts[p].prior.offset + offset;
  }
  start.cost = sums.yy - scale * sums.xy - offset * sums.y;
}

/// Relaxation to begin with: every term takes the same share, times spread over what the data can show.
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

/// Whether a start is a neighbour of one of `others` in the search.
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

/// Of starts, best first: the best `most` that are no neighbours, then the best of each other L_1.
std::vector<Solution> chosen_of(const std::vector<Solution>& all, std::size_t most) {
  constexpr std::size_t kLimit = 3;  // index of ln L_1
  std::vector<Solution> chosen;
  std::set<double> limits;
  for (const Solution& start : all) {
    if (chosen.size() == most) break;
    if (is_near(start, chosen)) continue;
    chosen.push_back(start);
    limits.insert(start.shared[kLimit]);
  }
  for (const Solution& start : all) {
    if (limits.contains(start.shared[kLimit]) || is_near(start, chosen)) continue;
    chosen.push_back(start);
    limits.insert(start.shared[kLimit]);
  }
  return chosen;
}

}  // namespace

std::vector<Solution> starts(const Problem& problem, std::size_t most) {
  double deepest = 0.0;  // m, past first contact
  for (const Part& part : problem.parts) {
    const double way = part.ranges.lowest_displacement + part.ranges.displacement -
                       part.prior.first_contact * part.ranges.displacement;
    deepest = std::max(deepest, way);
  }
  const double stiffness = problem.parts.front().ranges.force / deepest;
  std::vector<Solution> all;
  for (const Point& relaxation : relaxation_guesses(problem)) {
    for (const double limit : {0.1, 0.17, 0.25, 0.33, 0.37, 0.42, 0.47, 0.52, 0.64, 0.8, 1.1}) {
      for (const double q : {0.2, 0.35, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.3}) {
        for (const double beta : {0.5, 1.0, 1.3, 1.7, 2.2, 3.0, 8.0}) {
          Solution start;
          start.shared = {log(stiffness), log(beta), log(q), log(limit * deepest)};
          start.shared.insert(start.shared.end(), relaxation.begin(), relaxation.end());
          for (const Part& part : problem.parts)
            start.own.push_back({part.prior.first_contact, part.prior.offset});
          scale_and_judge(problem, start);
          if (std::isfinite(start.cost)) all.push_back(std::move(start));
        }
      }
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Solution& a, const Solution& b) { return a.cost < b.cost; });
  return chosen_of(all, most);
}

}  // namespace palpate::fit
