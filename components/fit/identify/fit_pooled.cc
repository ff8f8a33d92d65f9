#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/infinity.h"
#include "core/base/portable_math.h"
#include "core/base/random.h"
#include "core/base/statistics.h"
#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/identify.h"
#include "palpate/spring_law.h"
#include "palpate/units.h"
#include "run/tasks/for_each_task.h"

#include "fit/identify/fit_record.h"
#include "fit/identify/intervals.h"
#include "fit/identify/least_squares.h"
#include "fit/identify/local_optima.h"
#include "fit/identify/profile_path.h"
#include "fit/identify/size_exponent.h"
#include "fit/identify/warnings.h"

namespace palpate::identify {
namespace {

constexpr std::uint32_t kPooledJob = 0xffff'ffff;  // not the index of a specimen, so that its random numbers
                                                   // are its own
constexpr std::uint32_t kPooledStream = 3;
constexpr int kResamples = 100;  // of the set of specimens, for the intervals

/// The most frequent number of relaxation terms; the smallest on a tie.
std::size_t most_frequent_terms(const std::vector<SpecimenFit>& fits) {
  std::map<std::size_t, std::size_t> counts;
  for (const SpecimenFit& fit : fits) ++counts[fit.terms];
  const auto most = std::max_element(counts.begin(), counts.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most->first;
}

/// Starts for the pooled fit, from the specimens' fits with that number of terms: their median, and the three
/// with the lowest pooled cost.
std::vector<Solution> specimen_starts(const Problem& problem, const std::vector<SpecimenFit>& fits) {
  constexpr std::size_t kTaken = 3;
  std::vector<Point> own;
  for (const SpecimenFit& fit : fits) own.push_back(fit.own);
  std::vector<Solution> all;
  std::vector<std::vector<double>> columns(shared_count(problem.terms));
  for (const SpecimenFit& fit : fits) {
    if (fit.terms != problem.terms) continue;
    all.push_back({fit.shared, own, cost_of(problem, fit.shared, own)});
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i].push_back(fit.shared[i]);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Solution& a, const Solution& b) { return a.cost < b.cost; });
  if (all.size() > kTaken) all.resize(kTaken);
  Solution middle;
  for (const std::vector<double>& column : columns) middle.shared.push_back(quantile(column, 0.5));
  middle.own = own;
  all.push_back(std::move(middle));
  return all;
}

/// Shared parameters fitted to bootstrap resamples of the set of specimens.
std::vector<Point> resampled(const LocalOptima& optima, std::uint64_t seed, const Progress& progress,
                             tasks::Communicator* ranks) {
  const Solution& best = optima.all.front();
  const std::size_t count = optima.problem.parts.size();
  const auto resample = [&](std::size_t b) {
    Random random(seed, kPooledJob, kPooledStream);
    random.skip(b * count);
    std::vector<double> times(count, 0.0);
    for (std::size_t i = 0; i < count; ++i) times[random.below(count)] += 1.0;
    Problem problem = optima.problem;
    problem.parts.clear();
    Solution start;
    start.shared = best.shared;
    for (std::size_t p = 0; p < count; ++p) {
      if (times[p] == 0.0) continue;
      problem.parts.push_back(optima.problem.parts[p]);
      for (double& weight : problem.parts.back().weight) weight *= times[p];
      start.own.push_back(best.own[p]);
    }
    Point point = solve(problem, start, 20).shared;
    point.insert(point.end(), {0.0, 0.0});  // no own parameters
    return bytes_of(std::span<const double>(point));
  };
  int done = 0;
  const auto arrived = [&](std::size_t) {
    if (progress) progress(0.3 + 0.4 * ++done / kResamples, "pooled intervals");
  };
  std::vector<Point> points;
  for (const std::string& bytes : for_each_task(ranks, {kResamples, resample, {}, arrived, true}).results) {
    points.push_back(doubles_of(bytes));
  }
  return points;
}

PooledFit of_one(const SpecimenFit& fit, const Settings& settings) {
  PooledFit pooled;
  pooled.direction = settings.direction;
  pooled.terms = fit.terms;
  pooled.estimates.assign(fit.estimates.begin(),
                          fit.estimates.begin() + static_cast<std::ptrdiff_t>(shared_count(fit.terms)));
  pooled.layers_allowed = fit.layers_allowed;
  pooled.layers_reached = fit.layers_reached;
  pooled.rms = fit.rms;
  pooled.nrmse = fit.nrmse;
  pooled.points = fit.points;
  pooled.specimens = 1;
  pooled.shared = fit.shared;
  pooled.own = {fit.own};
  pooled.tissue = tissue_of(fit.shared, settings);
  return pooled;
}

/// Profile interval [logarithms] of each law parameter: how far it can move, all others fitted again, within
/// the confidence set. The bootstrap misses this range, because a refit from the optimum stays there when the
/// cost is flat.
std::vector<Interval> profile_intervals(const LocalOptima& optima, const Progress& progress,
                                        tasks::Communicator* ranks) {
  const Problem& problem = optima.problem;
  const Solution& best = optima.all.front();
  const std::vector<double> costs = part_costs(problem, best);
  const auto end_of = [&](std::size_t item) {
    const std::size_t index = item / 2;
    double end = best.shared[index];
    follow_profile_path(
        problem, best, index, item % 2 == 0 ? -1.0 : 1.0,
        [&](const Solution& at) {
          return in_confidence_set(costs, part_costs(problem, at)) ? 0.0 : kInfinity;
        },
        [&](const Solution& at) { end = at.shared[index]; });
    return bytes_of(std::span<const double>(&end, 1));
  };
  int done = 0;
  const auto arrived = [&](std::size_t) {
    if (progress) progress(0.7 + 0.3 * ++done / (2.0 * kLawParameters), "what the specimens leave open");
  };
  const std::vector<std::string> ends =
      for_each_task(ranks, {2 * kLawParameters, end_of, {}, arrived, true}).results;
  std::vector<Interval> intervals;
  for (std::size_t i = 0; i < kLawParameters; ++i) {
    intervals.push_back({doubles_of(ends[2 * i]).front(), doubles_of(ends[2 * i + 1]).front()});
  }
  return intervals;
}

/// Adds the shared parameters with their intervals, and a warning for each that is not determined.
void add_estimates(const LocalOptima& optima, const std::vector<Interval>& intervals,
                   const std::vector<Interval>& profiles, PooledFit& pooled) {
  const Point none(kOwnParameters, 0.0);
  const Bounds& bounds = optima.problem.bounds;
  const std::vector<double> values = values_of(optima.all.front().shared, none, {});
  for (std::size_t i = 0; i < shared_count(pooled.terms); ++i) {
    Estimate estimate;
    estimate.value = values[i];
    estimate.interval = {std::min(intervals[i].low, values[i]), std::max(intervals[i].high, values[i])};
    if (i < kLawParameters) {
      estimate.interval.low = std::min(estimate.interval.low, portable::exp(profiles[i].low));
      estimate.interval.high = std::max(estimate.interval.high, portable::exp(profiles[i].high));
      const Identifiability how =
          identifiability_of_interval(portable::log(estimate.interval.low),
                                      portable::log(estimate.interval.high), bounds.low[i], bounds.high[i]);
      estimate.determined = how == Identifiability::kIdentifiable;
      if (!estimate.determined) {
        pooled.warnings.push_back(undetermined_warning(how, labels(pooled.terms)[i], estimate.interval));
      }
    }
    pooled.estimates.push_back(estimate);
  }
}

/// @param factors of the specimens' measured forces against the fitted ones
void add_errors(const LocalOptima& optima, const std::vector<double>& factors, PooledFit& pooled) {
  const Solution& best = optima.all.front();
  double newtons = 0.0;
  double shares = 0.0;
  for (std::size_t p = 0; p < optima.problem.parts.size(); ++p) {
    const Part& part = optima.problem.parts[p];
    double squares = 0.0;
    for (const double r : plain_residuals(optima.problem, part, best.shared, best.own[p])) squares += r * r;
    const double range = factors[p] * part.ranges.force;
    newtons += squares * range * range;
    shares += squares / static_cast<double>(part.specimen->size());
    pooled.points += part.specimen->size();
    const LayerCount layers =
        layers_of(*part.specimen, part.ranges, optima.problem.settings, best.shared, best.own[p]);
    pooled.layers_allowed = layers.allowed;
    pooled.layers_reached = std::max(pooled.layers_reached, layers.reached);
  }
  pooled.rms = std::sqrt(newtons / static_cast<double>(pooled.points));
  pooled.nrmse = std::sqrt(shares / static_cast<double>(optima.problem.parts.size()));
}

/// Names the indenters' radius in the tissue, with the size exponent where they differ.
void add_size(const std::vector<Specimen>& specimens, const std::optional<SizeExponent>& size,
              PooledFit& pooled) {
  const double radius = reference_radius(specimens);
  if (radius > 0.0) pooled.tissue.source = model::SourceParameters{"indenter of the measurements", radius};
  if (!size) return;
  pooled.size = size;
  pooled.tissue.size_exponent = size->value;
  if (const std::string open = undetermined_size(*size); !open.empty()) pooled.warnings.push_back(open);
}

/// The fits as starts for forces of the reference indenter.
std::vector<SpecimenFit> at_reference_stiffness(std::vector<SpecimenFit> fits,
                                                const std::vector<double>& factors) {
  for (std::size_t i = 0; i < fits.size(); ++i) fits[i].shared[0] -= portable::log(factors[i]);  // ln k_1
  return fits;
}

/// Questions about specimens whose own fits give other forces at a depth that all reach: of very different
/// size (organs differ by a factor of two or three, units by more), or whose mean is not the pooled tissue's.
/// Each specimen has a first contact of its own, and an earlier one looks like more stiffness.
std::vector<std::string> unlike(const std::vector<Specimen>& specimens, const std::vector<SpecimenFit>& fits,
                                const std::vector<double>& factors, const Settings& settings,
                                const PooledFit& pooled) {
  constexpr double kUnlike = 5.0;
  constexpr double kOffMean = 0.1;
  double depth = kInfinity;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const Ranges ranges = ranges_of(specimens[i]);
    depth = std::min(depth,
                     ranges.lowest_displacement + ranges.displacement - fits[i].own[0] * ranges.displacement);
  }
  const auto force_of = [&](const model::TissueParameters& tissue) {
    return model::SpringLaw(tissue, settings.direction, settings.period).force_at(depth).force;
  };
  std::vector<double> forces;
  double logs = 0.0;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    forces.push_back(force_of(tissue_of(fits[i].shared, settings)) / factors[i]);
    logs += portable::log(forces.back());
  }
  const auto [least, most] = std::minmax_element(forces.begin(), forces.end());
  if (!(*least > 0.0)) return {};
  const std::string below = brief(depth / kMillimetre, 3) + " mm below contact";
  std::vector<std::string> questions;
  if (*most > kUnlike * *least) {
    const auto name = [&](const auto& at) {
      return fits[static_cast<std::size_t>(at - forces.begin())].name;
    };
    questions.push_back(fmt::format(
        "the specimens differ by a factor {}: {} {} carries {} N and {} {} N. One tissue is no good "
        "mean of them: are all in N and mm?",
        brief(*most / *least, 2), below, name(least), brief(*least, 3), name(most), brief(*most, 3)));
  }
  const double mean = portable::exp(logs / static_cast<double>(forces.size()));
  const double together = force_of(pooled.tissue);
  if (std::abs(together / mean - 1.0) > kOffMean) {
    questions.push_back(fmt::format(
        "{} all specimens together give {} N, their own fits {} N on average ({} to {} N): the pooled "
        "fit takes part of their difference for earlier or later contact. Use their own fits, or "
        "record more rows before contact",
        below, brief(together, 3), brief(mean, 3), brief(*least, 3), brief(*most, 3)));
  }
  return questions;
}

/// An error above the limit, as a sentence; rounded up, so that it does not print as the limit.
std::string poor_sentence(const std::string& name, double nrmse, double limit, const char* reason) {
  return fmt::format("the fit of {} has an error of {} of the force range, must be at most {}: {}", name,
                     percent(std::ceil(1e3 * nrmse) / 1e3, 1), percent(limit, 0), reason);
}

/// @throws InputError for an error over kNoFit
void require_fit(std::span<const SpecimenFit> fits, const PooledFit& pooled) {
  const std::string poor = poor_fit(fits, pooled, kNoFit);
  if (poor.empty()) return;
  throw InputError(
      poor + "; look at force_N over displacement_mm for wrong rows, and tare the sensor before contact");
}

}  // namespace

std::string poor_fit(std::span<const SpecimenFit> fits, const PooledFit& pooled, double limit) {
  const auto worst = std::max_element(fits.begin(), fits.end(),
                                      [](const auto& a, const auto& b) { return a.nrmse < b.nrmse; });
  if (worst != fits.end() && worst->nrmse > limit) {
    return poor_sentence("specimen " + worst->name, worst->nrmse, limit,
                         "the data do not have the law's shape");
  }
  if (limit == kPoorFit) {
    const auto poor =
        std::find_if(fits.begin(), fits.end(), [](const auto& one) { return !one.poor.empty(); });
    if (poor != fits.end()) return poor->poor;
  }
  if (!(pooled.nrmse > limit)) return "";
  return poor_sentence("all specimens together", pooled.nrmse, limit, "the specimens differ");
}

PooledFit fit_pooled(const std::vector<Specimen>& specimens, const std::vector<SpecimenFit>& fits,
                     const Settings& settings, const Progress& progress, tasks::Communicator* ranks) {
  if (specimens.empty() || specimens.size() != fits.size()) {
    throw InputError("pooled fit: needs at least one specimen, and a fit of each");
  }
  require_fit(fits, {});
  const std::optional<SizeExponent> size = fit_size_exponent(specimens, fits, settings);
  if (specimens.size() == 1) {
    PooledFit one = of_one(fits.front(), settings);
    add_size(specimens, size, one);
    return one;
  }
  const std::vector<double> factors = size_factors(specimens, size);
  const std::vector<Specimen> used = as_pooled(at_reference(specimens, size), settings);
  const std::size_t terms = most_frequent_terms(fits);
  Problem problem = make_problem(settings, terms, pooled_parts(used));
  if (progress) progress(0.05, "pooled fit");
  const std::vector<Solution> from = specimen_starts(problem, at_reference_stiffness(fits, factors));
  const LocalOptima optima = find_local_optima(std::move(problem), from);
  const std::vector<Interval> intervals =
      intervals_of(resampled(optima, settings.seed, progress, ranks), {}, terms);
  PooledFit pooled;
  pooled.direction = settings.direction;
  pooled.terms = terms;
  pooled.specimens = specimens.size();
  add_estimates(optima, intervals, profile_intervals(optima, progress, ranks), pooled);
  add_errors(optima, factors, pooled);
  pooled.shared = optima.all.front().shared;
  pooled.own = optima.all.front().own;
  pooled.tissue = tissue_of(pooled.shared, settings);
  add_size(specimens, size, pooled);
  require_finite_result("error of all specimens together", pooled.nrmse);
  for (const Estimate& one : pooled.estimates)
    require_finite_result("parameters of all specimens", one.value);
  require_fit({}, pooled);
  if (const std::string poor = poor_fit({}, pooled); !poor.empty()) pooled.warnings.push_back(poor);
  for (std::string& question : unlike(specimens, fits, factors, settings, pooled))
    pooled.warnings.push_back(std::move(question));
  constexpr std::size_t kFewSpecimens = 6;
  if (specimens.size() < kFewSpecimens) {
    pooled.warnings.push_back(
        fmt::format("the pooled intervals come from how {} specimens differ: too few to trust them to 95 %",
                    specimens.size()));
  }
  return pooled;
}

}  // namespace palpate::identify
