#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/portable_math.h"
#include "core/base/statistics.h"
#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/fit.h"
#include "science/fit/ensemble.h"
#include "science/fit/forward.h"
#include "science/fit/intervals.h"
#include "science/fit/minima.h"
#include "science/fit/parts.h"
#include "science/fit/resampling.h"
#include "science/fit/warnings.h"

namespace palpate::fit {
namespace {

void check(const Specimen& specimen, const Settings& settings) {
  if (specimen.size() < kFewestPoints) {
    throw InputError(fmt::format("specimen {}: has {} points, must have at least {}", specimen.name,
                                 specimen.size(), kFewestPoints));
  }
  if (settings.relaxation && specimen.time.empty()) {
    throw InputError("specimen " + specimen.name + ": has no column time_s, which --relaxation needs");
  }
}

/// Bayes's information criterion: ln of the effective number of points a parameter.
double criterion(const Minima& minima) {
  const double n = minima.effective;
  const auto points = static_cast<double>(minima.problem.parts.front().specimen->size());
  const auto parameters = static_cast<double>(shared_count(minima.problem.terms) + kOwnParameters);
  const double variance = std::max(minima.all.front().cost / points, kSmallestSigma * kSmallestSigma);
  return n * portable::log(variance) + parameters * portable::log(n);
}

/// The minima with as many relaxation terms as the data bear: one more as long as the criterion falls.
Minima with_terms(const Part& part, const Settings& settings, const Progress& progress) {
  constexpr double kWorthIt = 6.0;
  if (!settings.relaxation) return find_minima(make_problem(settings, 0, {part}));
  Minima best = find_minima(make_problem(settings, 1, {part}));
  for (std::size_t terms = 2; terms <= model::kMostRelaxationTerms; ++terms) {
    if (progress) progress(0.1 * static_cast<double>(terms), "relaxation terms");
    // besides the search: what was found, its slowest term split in two
    std::vector<Solution> more;
    for (const double factor : {0.15, 0.4, 3.0, 8.0}) {
      Solution start = best.all.front();
      const double share = start.shared[start.shared.size() - 2] - portable::log(2.0);
      const double time = start.shared.back();
      start.shared[start.shared.size() - 2] = share;
      start.shared.insert(start.shared.end(), {share, time + portable::log(factor)});
      more.push_back(std::move(start));
    }
    Minima tried = find_minima(make_problem(settings, terms, {part}), more);
    // both by the same count of independent points, the larger one
    const double effective = std::max(best.effective, tried.effective);
    best.effective = effective;
    tried.effective = effective;
    if (!(criterion(tried) < criterion(best) - kWorthIt)) break;
    best = std::move(tried);
  }
  const Solution& found = best.all.front();
  best.effective =
      effective_sample_size(plain_residuals(best.problem, part, found.shared, found.own.front()));
  return best;
}

/// The fitted curve with its band: at every point what 95 % of the ensemble's curves lie between.
Curve curve_of(const Minima& minima, const std::vector<Point>& points) {
  constexpr std::size_t kCurves = 240;
  const Part& part = minima.problem.parts.front();
  const Specimen& specimen = *part.specimen;
  Curve curve;
  curve.time = specimen.time;
  curve.displacement = specimen.displacement;
  curve.measured = specimen.force;
  curve.fitted.resize(specimen.size());
  const Solution& best = minima.all.front();
  predict(specimen, part.ranges, minima.problem.settings, best.shared, best.own.front(), curve.fitted);
  std::vector<std::vector<double>> forces(specimen.size());
  std::vector<double> force(specimen.size());
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kCurves);
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const std::span<const double> all(points[i]);
    const std::size_t shared = best.shared.size();
    predict(specimen, part.ranges, minima.problem.settings, all.first(shared), all.subspan(shared), force);
    for (std::size_t k = 0; k < force.size(); ++k) forces[k].push_back(force[k]);
  }
  for (const std::vector<double>& at : forces) {
    curve.low.push_back(quantile(at, 0.025));
    curve.high.push_back(quantile(at, 0.975));
  }
  return curve;
}

/// What the data leave besides the best fit.
struct Likely {
  double effective = 0.0;  // points that count as independent
  Ensemble ensemble;
  std::vector<Point> profiles;  // points along them
};

Solution solution_at(const Problem& problem, const Point& point) {
  const auto own = point.end() - static_cast<std::ptrdiff_t>(kOwnParameters);
  Solution solution{Point(point.begin(), own), {Point(own, point.end())}};
  solution.cost = cost_of(problem, solution.shared, solution.own);
  return solution;
}

/// The point of the ensemble and that of the profiles that are closest to the data.
std::vector<Solution> closest_of(const Problem& problem, const Likely& likely) {
  const std::vector<double>& chances = likely.ensemble.log_posterior;
  const auto likeliest = std::max_element(chances.begin(), chances.end()) - chances.begin();
  std::vector<Solution> closest = {
      solution_at(problem, likely.ensemble.points[static_cast<std::size_t>(likeliest)])};
  closest.push_back(closest.front());
  for (const Point& point : likely.profiles) {
    Solution solution = solution_at(problem, point);
    if (solution.cost < closest.back().cost) closest.back() = std::move(solution);
  }
  return closest;
}

/// Draws the ensemble and walks the profiles, and does so again where they lead to a better fit than the
/// search had found: then that is the fit.
Likely look_around(Minima& minima, std::size_t points, const Settings& settings, std::uint32_t job,
                   const std::function<void(double)>& progress) {
  constexpr int kMostRounds = 3;
  double furthest = 0.0;  // a bar never goes back
  const auto part_of = [&](double from, double to) {
    return [&progress, &furthest, from, to](double share) {
      furthest = std::max(furthest, from + share * (to - from));
      if (progress) progress(furthest);
    };
  };
  Likely likely;
  for (int round = 1;; ++round) {
    const std::size_t parameters = minima.all.front().shared.size() + kOwnParameters;
    likely.effective = trusted_count(minima.effective, points, parameters);
    likely.ensemble =
        draw_ensemble(minima.problem, minima.all, likely.effective, settings.seed, job, part_of(0.0, 0.5));
    likely.profiles = profile_points(minima, likely.effective, part_of(0.5, 1.0));
    if (round == kMostRounds || !descend_further(minima, closest_of(minima.problem, likely))) return likely;
  }
}

/// Intervals that hold both what 95 % of the ensemble lie between and what is nearly as likely as the best:
/// where the data say little, the first alone is drawn to where there is most room, away from a truth that
/// fits as well.
std::vector<Interval> both_intervals(const Minima& minima, const Likely& likely) {
  const Ranges& ranges = minima.problem.parts.front().ranges;
  const std::size_t terms = minima.problem.terms;
  std::vector<Interval> intervals = intervals_of(likely.ensemble.points, ranges, terms);
  std::vector<Point> near = nearly_best(likely.ensemble, likely.effective);
  near.insert(near.end(), likely.profiles.begin(), likely.profiles.end());
  for (const Point& point : near) {
    const std::span<const double> all(point);
    const std::size_t shared = shared_count(terms);
    const std::vector<double> values = values_of(all.first(shared), all.subspan(shared), ranges);
    for (std::size_t i = 0; i < values.size(); ++i) {
      intervals[i].low = std::min(intervals[i].low, values[i]);
      intervals[i].high = std::max(intervals[i].high, values[i]);
    }
  }
  return intervals;
}

void add_estimates(const Minima& minima, const std::vector<Interval>& intervals,
                   const std::vector<Point>& resampled, SpecimenFit& fit) {
  const Part& part = minima.problem.parts.front();
  const Solution& best = minima.all.front();
  const std::vector<double> values = values_of(best.shared, best.own.front(), part.ranges);
  const auto covariance = covariance_intervals(minima);
  std::vector<Interval> bootstrap;
  if (!resampled.empty()) bootstrap = intervals_of(resampled, part.ranges, fit.terms);
  for (std::size_t i = 0; i < values.size(); ++i) {
    Estimate estimate;
    estimate.value = values[i];
    // the best fit of a law with corners can lie at the edge of what the data allow: never outside
    estimate.interval = {std::min(intervals[i].low, values[i]), std::max(intervals[i].high, values[i])};
    estimate.covariance = covariance[i];
    if (!bootstrap.empty()) estimate.bootstrap = bootstrap[i];
    fit.estimates.push_back(estimate);
  }
}

void add_errors(const Minima& minima, SpecimenFit& fit) {
  const Part& part = minima.problem.parts.front();
  double squares = 0.0;
  for (const double r : plain_residuals(minima.problem, part, fit.shared, fit.own)) squares += r * r;
  fit.nrmse = std::sqrt(squares / static_cast<double>(fit.points));
  fit.rms = fit.nrmse * part.ranges.force;
  fit.leave_out = leave_out_error(minima);
}

}  // namespace

SpecimenFit fit_specimen(const Specimen& specimen, const Settings& settings, std::uint32_t job,
                         const Progress& progress, Crew* crew) {
  check(specimen, settings);
  const auto told = [&progress](double from, double to, const char* what) {
    return [&progress, from, to, what](double share) {
      if (progress) progress(from + share * (to - from), what);
    };
  };
  const Specimen used = as_fitted(specimen, settings);
  const Part part = make_part(used);
  Minima minima = with_terms(part, settings, progress);
  const double most = settings.bootstrap > 0 ? 0.6 : 0.95;
  const Likely likely = look_around(minima, used.size(), settings, job, told(0.3, most, "intervals"));
  const Ensemble& ensemble = likely.ensemble;
  SpecimenFit fit;
  fit.name = specimen.name;
  fit.law = settings.law;
  fit.terms = minima.problem.terms;
  fit.points = used.size();
  fit.rows = specimen.size();
  fit.shared = minima.all.front().shared;
  fit.own = minima.all.front().own.front();
  for (std::size_t i = 1; i < minima.all.size(); ++i) {
    fit.minima.push_back(minima.all[i].shared);
    const Point& own = minima.all[i].own.front();
    fit.minima.back().insert(fit.minima.back().end(), own.begin(), own.end());
  }
  const LayerCount layers = layers_of(used, part.ranges, settings, fit.shared, fit.own);
  fit.layers_allowed = layers.allowed;
  fit.layers_reached = layers.reached;
  const std::vector<Point> resampled =
      bootstrap(minima, settings.bootstrap, settings.seed, job, told(most, 0.95, "bootstrap"), crew);
  add_estimates(minima, both_intervals(minima, likely), resampled, fit);
  const std::vector<Determined> determined = determined_of(minima, ensemble.points);
  for (std::size_t i = 0; i < determined.size(); ++i) {
    fit.estimates[i].determined = determined[i] == Determined::kYes;
  }
  add_errors(minima, fit);
  fit.curve = curve_of(minima, ensemble.points);
  fit.warnings = warnings_of(minima, ensemble, fit);
  return fit;
}

}  // namespace palpate::fit
