#include "fit/identify/warnings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/units.h"

namespace palpate::identify {
namespace {

/// Three digits are enough for a sentence.
void add_undetermined(const std::vector<Identifiability>& determined, const SpecimenFit& fit,
                      std::vector<std::string>& out) {
  const std::vector<ParameterLabel> names = labels(fit.terms);
  for (std::size_t i = 0; i < determined.size(); ++i) {
    if (determined[i] == Identifiability::kIdentifiable) continue;
    out.push_back(undetermined_warning(determined[i], names[i], fit.estimates[i].interval));
  }
}

/// What to measure when the law's shape is poorly determined.
std::string advice(const SpecimenFit& fit, const Part& part) {
  const double q = fit.estimates[2].value;
  const double third_layer =
      fit.estimates[4 + 2 * fit.terms].value + fit.estimates[3].value * (1.0 + q * (1.0 + q));
  const double deepest = part.ranges.lowest_displacement + part.ranges.displacement;
  if (deepest < third_layer) {
    return "measure to about " + brief(third_layer / kMillimetre, 3) +
           " mm, where the third layer of this fit ends";
  }
  return "measure more points, or with less noise";
}

void add_wide_law(const SpecimenFit& fit, const Part& part, std::vector<std::string>& out) {
  constexpr double kFactor = 2.0;
  std::string wide;
  for (const std::size_t i : {std::size_t{1}, std::size_t{2}}) {
    const Interval& interval = fit.estimates[i].interval;
    if (interval.high > kFactor * interval.low) wide += (wide.empty() ? "" : " and ") + labels(0)[i].name;
  }
  if (wide.empty()) return;
  out.push_back("the interval of " + wide +
                " is wider than a factor 2, because L_1, q and beta compensate each other: " +
                advice(fit, part) + "; the curve itself is determined better");
}

/// Uncertainty of the force in the deeper half of the data due to noise at first contact. A law is a force
/// over the depth from contact.
void add_contact(const Problem& problem, const SpecimenFit& fit, std::vector<std::string>& out) {
  constexpr double kUncertain = 0.02;  // of the force
  const Part& part = problem.parts.front();
  const double deepest = part.ranges.lowest_displacement + part.ranges.displacement * (1.0 - fit.own[0]);
  const double error = part.specimen->preparation.contact_error;
  double largest = 0.0;
  double at = 0.0;  // m
  for (const double share : {0.5, 0.75, 1.0}) {
    const double depth = share * deepest;
    const Specimen depths{"", {}, {depth, depth - error}, {0.0, 0.0}};
    std::vector<double> force(depths.size());
    predict(depths, part.ranges, problem.settings, fit.shared, Point(kOwnParameters, 0.0), force);
    const double uncertain = 1.0 - force[1] / force[0];
    if (!(uncertain > largest)) continue;
    largest = uncertain;
    at = depth;
  }
  if (!(largest > kUncertain)) return;
  out.push_back(
      fmt::format("noise in the first rows makes first contact uncertain by {} mm or more, and the force at "
                  "{} mm by {} or more: measure with less noise, or more rows around first contact",
                  brief(error / kMillimetre, 2), brief(at / kMillimetre, 3), percent(largest, 0)));
}

/// A curve whose first row is already in contact: only the law's shape says where contact is. Where the first
/// reading was subtracted, a note says so.
void add_start_at_depth(const Problem& problem, const SpecimenFit& fit, std::vector<std::string>& out) {
  constexpr double kNoticeable = 0.01;  // of the force range
  const Part& part = problem.parts.front();
  const Preparation& preparation = part.specimen->preparation;
  if (preparation.contact || preparation.zero > 0.0) return;
  const double first = part.ranges.lowest_displacement;
  const Specimen first_row{"", {}, {first}, {0.0}};
  double force = 0.0;
  predict(first_row, part.ranges, problem.settings, fit.shared, Point{fit.own[0], 0.0}, {&force, 1});
  if (!(force > kNoticeable * part.ranges.force)) return;
  out.push_back(fmt::format(
      "no row shows first contact: at the first row, {} mm, the fitted tissue already carries {} N, {} of "
      "the "
      "range of force, and only the law's shape puts contact at {} mm. The force may be far off: start 1 mm "
      "above the tissue, or tare the sensor",
      brief(first / kMillimetre, 3), brief(force, 2), percent(force / part.ranges.force, 0),
      brief(fit.own[0] * part.ranges.displacement / kMillimetre, 3)));
}

void add_data(const LocalOptima& optima, const SpecimenFit& fit, std::vector<std::string>& out) {
  constexpr double kDoubted = 1.3;  // of the noise of a point
  const Problem& problem = optima.problem;
  const Part& part = problem.parts.front();
  const Preparation& preparation = part.specimen->preparation;
  const double averaged = std::sqrt(static_cast<double>(fit.points) / static_cast<double>(preparation.rows));
  out.insert(out.end(), preparation.notes.begin(), preparation.notes.end());
  if (!preparation.doubt.empty() && fit.rms > kDoubted * preparation.noise * averaged)
    out.push_back(preparation.doubt);
  if (preparation.rows > fit.points) {
    out.push_back(fmt::format("{} rows were averaged to {} points", preparation.rows, fit.points));
  }
  if (const std::string poor = poor_fit({&fit, 1}, {}); !poor.empty()) out.push_back(poor);
  const std::vector<double> left = plain_residuals(problem, part, fit.shared, fit.own);
  const double limit = 1.5 * problem.loss_scale;  // six standard deviations
  const auto outliers =
      std::count_if(left.begin(), left.end(), [limit](double r) { return std::abs(r) > limit; });
  if (outliers > 0 && problem.loss_scale > 1e-4) {
    out.push_back(fmt::format("{}{} far off the curve and hardly counted (Cauchy's loss)", outliers,
                              outliers == 1 ? " point lies" : " points lie"));
  }
  constexpr double kLongFlat = 0.15;  // of the range of displacement
  const double flat = flat_until(*part.specimen, part.ranges);
  if (!preparation.contact && flat - part.ranges.lowest_displacement > kLongFlat * part.ranges.displacement) {
    out.push_back(
        "the force does not rise out of the noise before " + brief(flat / kMillimetre, 3) +
        " mm: if that is motion without contact, cut it off and count displacement from contact; if it is "
        "tissue, its first layer is hardly visible");
  }
  if (fit.layers_reached < 2) {
    out.emplace_back("the data stay within the first layer: they do not determine beta and q");
  }
  if (optima.effective < 0.5 * static_cast<double>(fit.points)) {
    out.push_back(
        fmt::format("residuals are autocorrelated, so {} points count as {} in the intervals: the law "
                    "does not fit the curve's shape everywhere",
                    fit.points, brief(optima.effective, 3)));
  }
}

}  // namespace

Identifiability identifiability_of_interval(double low, double high, double lowest, double highest) {
  const double whole = highest - lowest;
  if (high - low > 0.5 * whole) return Identifiability::kSpansSearchRange;
  const bool at_end = low - lowest < 0.03 * whole || highest - high < 0.03 * whole;
  return at_end ? Identifiability::kAtSearchBound : Identifiability::kIdentifiable;
}

std::string undetermined_warning(Identifiability how, const ParameterLabel& label, const Interval& interval) {
  return fmt::format("{} is not determined by the data: its interval, {} to {}{}", label.name,
                     brief(interval.low / label.unit, 3), brief(interval.high / label.unit, 3),
                     how == Identifiability::kSpansSearchRange ? ", spans most of the searched range"
                                                               : ", ends at a bound of the search");
}

std::vector<std::string> correlated_warnings(const std::vector<std::vector<double>>& correlations,
                                             const std::vector<ParameterLabel>& names) {
  constexpr double kReportedFrom = 0.99;
  std::vector<std::size_t> set_of(correlations.size());  // of each parameter
  for (std::size_t i = 0; i < set_of.size(); ++i) {
    set_of[i] = i;
    for (std::size_t k = 0; k < i; ++k) {
      if (!(std::abs(correlations[k][i]) > kReportedFrom)) continue;
      const std::size_t joining = set_of[k];
      std::replace(set_of.begin(), set_of.begin() + static_cast<std::ptrdiff_t>(i), joining, i);
    }
  }
  std::vector<std::string> out;
  for (std::size_t set = 0; set < set_of.size(); ++set) {
    std::vector<std::string> members;
    for (std::size_t i = 0; i < set_of.size(); ++i) {
      if (set_of[i] == set) members.push_back(names[i].name);
    }
    if (members.size() < 2) continue;
    const std::string last = std::move(members.back());
    members.pop_back();
    out.push_back(fmt::format("{} and {} are only determined together (correlation over {}): read none alone",
                              palpate::joined(members), last, kReportedFrom));
  }
  return out;
}

std::vector<Identifiability> identifiability_of(const LocalOptima& optima, const std::vector<Point>& points) {
  const Bounds& bounds = optima.problem.bounds;
  std::vector<Identifiability> determined;
  for (std::size_t i = 0; i < bounds.low.size(); ++i) {
    const auto [low, high] = std::minmax_element(points.begin(), points.end(),
                                                 [i](const Point& a, const Point& b) { return a[i] < b[i]; });
    determined.push_back(identifiability_of_interval((*low)[i], (*high)[i], bounds.low[i], bounds.high[i]));
  }
  return determined;
}

std::vector<std::string> warnings_of(const LocalOptima& optima, const std::vector<Point>& points,
                                     const Curvature& curvature, const SpecimenFit& fit) {
  std::vector<std::string> out;
  add_data(optima, fit, out);
  add_contact(optima.problem, fit, out);
  add_start_at_depth(optima.problem, fit, out);
  add_undetermined(identifiability_of(optima, points), fit, out);
  for (std::string& warning : correlated_warnings(curvature.correlations, labels(fit.terms))) {
    out.push_back(std::move(warning));
  }
  add_wide_law(fit, optima.problem.parts.front(), out);
  return out;
}

}  // namespace palpate::identify
