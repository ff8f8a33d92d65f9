#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/portable_math.h"
#include "palpate/error.h"
#include "palpate/identify.h"

#include "fit/identify/fit_record.h"
#include "fit/identify/intervals.h"
#include "fit/identify/least_squares.h"
#include "fit/identify/loading.h"
#include "fit/identify/local_optima.h"
#include "fit/identify/plausible_specimen.h"
#include "fit/identify/warnings.h"

namespace palpate::identify {
namespace {

/// The specimen with the checks of a file's reader, which programs have not made. @throws InputError
Specimen checked(Specimen specimen, const Settings& settings) {
  const std::string where = "specimen " + specimen.name;
  if (settings.relaxation && specimen.time.empty()) {
    throw InputError(where + ": has no column time_s, which --relaxation needs");
  }
  check_specimen(specimen, where);
  if (settings.relaxation) require_unsaturated(specimen, where);
  return specimen;
}

/// Bayesian information criterion: a penalty of ln(effective number of points) per parameter.
double bayesian_criterion(const LocalOptima& optima) {
  const double n = optima.effective;
  const auto points = static_cast<double>(optima.problem.parts.front().specimen->size());
  const auto parameters = static_cast<double>(shared_count(optima.problem.terms) + kOwnParameters);
  const double variance = std::max(optima.all.front().cost / points, kSmallestSigma * kSmallestSigma);
  return n * portable::log(variance) + parameters * portable::log(n);
}

/// Local optima with as many relaxation terms as the data support: terms are added while the criterion falls.
LocalOptima with_terms(const Part& part, const Settings& settings, const Progress& progress) {
  constexpr double kWorthIt = 6.0;
  constexpr std::size_t kStarts = 4;  // per value of L_1
  constexpr std::size_t kSplit = 4;   // number of optima whose slowest term is split
  if (!settings.relaxation) return find_local_optima(make_problem(settings, 0, {part}));
  const Problem one = make_problem(settings, 1, {part});
  LocalOptima best = run_multistart(one, multistart_points(one, kStarts));
  for (std::size_t terms = 2; terms <= model::kMaxRelaxationTerms; ++terms) {
    if (progress) progress(0.1 * static_cast<double>(terms), "relaxation terms");
    // the optima with one term fewer, their slowest term split in two
    std::vector<Solution> from;
    for (std::size_t m = 0; m < std::min(kSplit, best.all.size()); ++m) {
      for (const double factor : {0.05, 0.15, 0.4, 3.0, 8.0}) {
        Solution start = best.all[m];
        const double share = start.shared[start.shared.size() - 2] - portable::log(2.0);
        const double time = start.shared.back();
        start.shared[start.shared.size() - 2] = share;
        start.shared.insert(start.shared.end(), {share, time + portable::log(factor)});
        from.push_back(std::move(start));
      }
    }
    LocalOptima tried = run_multistart(make_problem(settings, terms, {part}), from);
    // compare both with the same effective number of points, the larger one
    const double effective = std::max(best.effective, tried.effective);
    best.effective = effective;
    tried.effective = effective;
    if (!(bayesian_criterion(tried) < bayesian_criterion(best) - kWorthIt)) break;
    best = std::move(tried);
  }
  if (best.problem.terms > 1) {  // the best law may differ with more terms
    std::vector<Solution> from = multistart_points(best.problem, kStarts);
    from.insert(from.begin(), best.all.begin(), best.all.end());
    best = run_multistart(make_problem(settings, best.problem.terms, {part}), from);
  }
  refine_optima(best);
  return best;
}

/// The fitted curve and its band, the envelope of the curves in the confidence set.
Curve curve_of(const LocalOptima& optima, const std::vector<Point>& points) {
  const Part& part = optima.problem.parts.front();
  const Specimen& specimen = *part.specimen;
  Curve curve;
  curve.time = specimen.time;
  curve.displacement = specimen.displacement;
  curve.measured = specimen.force;
  curve.fitted.resize(specimen.size());
  const Solution& best = optima.all.front();
  predict(specimen, part.ranges, optima.problem.settings, best.shared, best.own.front(), curve.fitted);
  curve.low = curve.fitted;
  curve.high = curve.fitted;
  std::vector<double> force(specimen.size());
  for (const Point& point : points) {
    const std::span<const double> all(point);
    const std::size_t shared = best.shared.size();
    predict(specimen, part.ranges, optima.problem.settings, all.first(shared), all.subspan(shared), force);
    for (std::size_t k = 0; k < force.size(); ++k) {
      curve.low[k] = std::min(curve.low[k], force[k]);
      curve.high[k] = std::max(curve.high[k], force[k]);
    }
  }
  for (std::size_t k = 0; k < force.size(); ++k) {  // the sensor's readings
    const double baseline = specimen.preparation.baseline(curve.displacement[k]);
    for (std::vector<double>* forces : {&curve.measured, &curve.fitted, &curve.low, &curve.high}) {
      (*forces)[k] += baseline;
    }
  }
  return curve;
}

/// Points along the profiles. Where a profile finds a better fit than the search, that fit replaces the best
/// one and the profiles are computed again from it.
std::vector<Point> search_along_profiles(LocalOptima& optima, std::size_t points,
                                         const std::function<void(double)>& progress) {
  constexpr int kMaxRounds = 3;
  double furthest = 0.0;  // progress never decreases
  const auto shown = [&](double share) {
    furthest = std::max(furthest, share);
    if (progress) progress(furthest);
  };
  for (int round = 1;; ++round) {
    const std::size_t parameters = optima.all.front().shared.size() + kOwnParameters;
    const double effective = limited_sample_size(optima.effective, points, parameters);
    std::vector<Point> profiles = profile_points(optima, effective, shown);
    Solution closest;
    for (const Point& point : profiles) {
      Solution solution = solution_at(optima.problem, point);
      if (solution.cost < closest.cost || closest.shared.empty()) closest = std::move(solution);
    }
    if (round == kMaxRounds || !try_more_starts(optima, {closest})) return profiles;
  }
}

/// Adds a force [N] to an estimate and its intervals.
void shift(Estimate& estimate, double by) {
  const auto move = [by](Interval& interval) { interval = {interval.low + by, interval.high + by}; };
  estimate.value += by;
  move(estimate.interval);
  if (estimate.covariance) move(*estimate.covariance);
  if (estimate.bootstrap) move(*estimate.bootstrap);
}

void add_estimates(const LocalOptima& optima, const std::vector<Point>& profiles, const Curvature& curvature,
                   const std::vector<Point>& resampled, SpecimenFit& fit) {
  const Part& part = optima.problem.parts.front();
  const Solution& best = optima.all.front();
  const std::vector<double> values = values_of(best.shared, best.own.front(), part.ranges);
  const std::vector<Interval> intervals = intervals_of(profiles, part.ranges, fit.terms, 1.0);
  std::vector<Interval> bootstrap;
  if (!resampled.empty()) bootstrap = intervals_of(resampled, part.ranges, fit.terms);
  for (std::size_t i = 0; i < values.size(); ++i) {
    Estimate estimate;
    estimate.value = values[i];
    // for a law with corners the optimum can lie at the edge of the confidence set, but not outside
    estimate.interval = {std::min(intervals[i].low, values[i]), std::max(intervals[i].high, values[i])};
    estimate.covariance = curvature.intervals[i];
    if (!bootstrap.empty()) estimate.bootstrap = bootstrap[i];
    fit.estimates.push_back(estimate);
  }
  shift(fit.estimates.back(), part.specimen->preparation.zero);
}

void add_errors(const LocalOptima& optima, SpecimenFit& fit) {
  const Part& part = optima.problem.parts.front();
  double squares = 0.0;
  for (const double r : plain_residuals(optima.problem, part, fit.shared, fit.own)) squares += r * r;
  fit.nrmse = std::sqrt(squares / static_cast<double>(fit.points));
  fit.rms = fit.nrmse * part.ranges.force;
  fit.cross_validation = cross_validation_error(optima);
}

}  // namespace

SpecimenFit fit_specimen(const Specimen& given, const Settings& settings, std::uint32_t job,
                         const Progress& progress, tasks::Communicator* ranks) {
  const Specimen specimen = checked(given, settings);
  const auto reported = [&progress](double from, double to, const char* what) {
    return [&progress, from, to, what](double share) {
      if (progress) progress(from + share * (to - from), what);
    };
  };
  const Specimen used = as_fitted(specimen, settings);
  const Part part = make_part(used);
  LocalOptima optima = with_terms(part, settings, progress);
  const double most = settings.bootstrap > 0 ? 0.6 : 0.95;
  const std::vector<Point> profiles =
      search_along_profiles(optima, used.size(), reported(0.3, most, "intervals"));
  const Curvature curvature = curvature_of(optima);
  SpecimenFit fit;
  fit.name = specimen.name;
  fit.law = settings.law;
  fit.terms = optima.problem.terms;
  fit.points = used.size();
  fit.rows = specimen.size();
  fit.shared = optima.all.front().shared;
  fit.own = optima.all.front().own.front();
  for (std::size_t i = 1; i < optima.all.size(); ++i) {
    fit.local_optima.push_back(optima.all[i].shared);
    const Point& own = optima.all[i].own.front();
    fit.local_optima.back().insert(fit.local_optima.back().end(), own.begin(), own.end());
  }
  const LayerCount layers = layers_of(used, part.ranges, settings, fit.shared, fit.own);
  fit.layers_allowed = layers.allowed;
  fit.layers_reached = layers.reached;
  const std::vector<Point> resampled =
      bootstrap(optima, settings.bootstrap, settings.seed, job, reported(most, 0.95, "bootstrap"), ranks);
  add_estimates(optima, profiles, curvature, resampled, fit);
  const std::vector<Identifiability> determined = identifiability_of(optima, profiles);
  for (std::size_t i = 0; i < determined.size(); ++i) {
    fit.estimates[i].determined = determined[i] == Identifiability::kIdentifiable;
  }
  add_errors(optima, fit);
  require_finite_result("error", fit.nrmse);
  for (const Estimate& one : fit.estimates) require_finite_result("parameters", one.value);
  fit.curve = curve_of(optima, profiles);
  Misfit misfit = misfit_of(optima, fit);
  fit.poor = std::move(misfit.poor);
  if (fit.poor.empty() && !used.preparation.poor.empty()) {
    fit.poor = fmt::format("the rows of specimen {} give no tissue: {}", fit.name, used.preparation.poor);
  }
  Misfit doubts = warnings_of(optima, profiles, curvature, fit, misfit.nearer_law);
  if (fit.poor.empty()) fit.poor = std::move(doubts.poor);
  fit.warnings = std::move(doubts.warnings);
  fit.warnings.insert(fit.warnings.begin(), misfit.warnings.begin(), misfit.warnings.end());
  for (std::string& question : unit_questions(specimen)) fit.warnings.push_back(std::move(question));
  std::string question = settings.relaxation ? time_unit_question(specimen) : exchange_question(used);
  if (!question.empty()) fit.warnings.push_back(std::move(question));
  if (specimen.empty_rows > 0) {
    fit.warnings.push_back(
        fmt::format("{} of 0 mm and 0 N after others left out",
                    specimen.empty_rows == 1 ? "1 row" : fmt::format("{} rows", specimen.empty_rows)));
  }
  return fit;
}

}  // namespace palpate::identify
