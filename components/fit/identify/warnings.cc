#include "fit/identify/warnings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/units.h"

#include "fit/identify/least_squares.h"

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

/// Forces [N] of a fit at depths [m] below its first contact.
std::vector<double> forces_below_contact(const Problem& problem, std::span<const double> shared,
                                         const std::vector<double>& depths) {
  const Specimen at{"", {}, depths, std::vector<double>(depths.size())};
  std::vector<double> force(depths.size());
  predict(at, problem.parts.front().ranges, problem.settings, shared, Point(kOwnParameters, 0.0), force);
  return force;
}

/// Where the force in the deeper half of the data is most uncertain.
struct Uncertainty {
  double share = 0.0;  // of the force
  double depth = 0.0;  // m
  double later = 0.0;  // rows from the fit's first contact to the other law's, a share of the displacement
};

constexpr double kUncertain = 0.02;           // of the force
constexpr double kUncertainBesideRows = 0.2;  // where rows show first contact: less is noise around it
constexpr double kAir = 0.1;                  // of the displacement

/// A law that does not follow the curve everywhere: then misfit, not noise, allows other laws.
bool autocorrelated(const LocalOptima& optima, const SpecimenFit& fit) {
  return optima.effective < 0.5 * static_cast<double>(fit.points);
}

/// @param nearer_law of Misfit
std::string no_tissue_text(const SpecimenFit& fit, const std::string& why, const std::string& nearer_law) {
  return fmt::format("the rows of specimen {} give no tissue: {}{}{}", fit.name, why,
                     nearer_law.empty() ? "" : "; ", nearer_law);
}

/// Uncertainty due to noise at first contact: a law is a force over the depth from contact.
Uncertainty uncertainty_by_contact(const Problem& problem, const SpecimenFit& fit, double deepest) {
  const double error = problem.parts.front().specimen->preparation.contact_error;
  Uncertainty largest;
  for (const double share : {0.5, 0.75, 1.0}) {
    const double depth = share * deepest;
    const std::vector<double> force = forces_below_contact(problem, fit.shared, {depth, depth - error});
    const double off = 1.0 - force[1] / force[0];
    if (off > largest.share) largest = {off, depth};
  }
  return largest;
}

/// Uncertainty due to the other laws, each with its own first contact, that the data allow: at depths that
/// both laws reach in the rows.
Uncertainty uncertainty_by_law(const Problem& problem, const std::vector<Point>& points,
                               const SpecimenFit& fit) {
  const Ranges& ranges = problem.parts.front().ranges;
  const double touching = std::max(fit.own[0], ranges.lowest_displacement / ranges.displacement);
  Uncertainty largest;
  for (const Point& point : points) {
    const double contact = std::max(fit.own[0], point[fit.shared.size()]);
    const double deepest = ranges.lowest_displacement + ranges.displacement * (1.0 - contact);
    const std::vector<double> depths = {0.5 * deepest, 0.75 * deepest, deepest};
    const std::vector<double> best = forces_below_contact(problem, fit.shared, depths);
    const std::vector<double> force =
        forces_below_contact(problem, std::span(point).first(fit.shared.size()), depths);
    for (std::size_t i = 0; i < depths.size(); ++i) {
      const double off = best[i] > 0.0 ? std::abs(force[i] / best[i] - 1.0) : 0.0;
      if (off > largest.share) largest = {off, depths[i], point[fit.shared.size()] - touching};
    }
  }
  return largest;
}

/// No tissue comes from a force that may be over 100 % off where the rows show first contact, where they may
/// begin with air (another first contact is later, and misfit does not explain it), or where the other law is
/// much nearer to them.
void add_uncertainty(const LocalOptima& optima, const std::vector<Point>& points, const SpecimenFit& fit,
                     const std::string& nearer_law, Misfit& out) {
  const Problem& problem = optima.problem;
  const Part& part = problem.parts.front();
  const double deepest = part.ranges.lowest_displacement + part.ranges.displacement * (1.0 - fit.own[0]);
  const Uncertainty contact = uncertainty_by_contact(problem, fit, deepest);
  if (contact.share > kUncertain) {
    out.warnings.push_back(fmt::format(
        "noise in the first rows makes first contact uncertain by {} mm or more, and the force at "
        "{} mm by {} or more: measure with less noise, or more rows around first contact",
        brief(part.specimen->preparation.contact_error / kMillimetre, 2),
        brief(contact.depth / kMillimetre, 3), percent(contact.share, 0)));
  }
  const Uncertainty law = uncertainty_by_law(problem, points, fit);
  const bool shown = part.specimen->preparation.contact.has_value();
  if (!(law.share > std::max(shown ? kUncertainBesideRows : kUncertain, contact.share))) return;
  const std::string text = fmt::format(
      "other laws and first contacts fit the rows as well (95 %), so that the force {} mm below contact is "
      "uncertain by {}: measure with less noise, or start 1 mm above the tissue",
      brief(law.depth / kMillimetre, 3), law.share > 1.0 ? "over 100 %" : percent(law.share, 0));
  out.warnings.push_back(text);
  const bool may_be_air = law.later > kAir && !autocorrelated(optima, fit);
  if (law.share > 1.0 && (shown || may_be_air || !nearer_law.empty()))
    out.poor = no_tissue_text(fit, text, nearer_law);
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
      "the range of force, and only the law's shape puts contact at {} mm. The force may be far off: start 1 "
      "mm above the tissue, or tare the sensor",
      brief(first / kMillimetre, 3), brief(force, 2), percent(force / part.ranges.force, 0),
      brief(fit.own[0] * part.ranges.displacement / kMillimetre, 3)));
}

void add_data(const LocalOptima& optima, const SpecimenFit& fit, const std::string& nearer_law, Misfit& out) {
  constexpr double kDoubted = 1.3;  // of the noise of a point
  const Problem& problem = optima.problem;
  const Part& part = problem.parts.front();
  const Preparation& preparation = part.specimen->preparation;
  const double averaged = std::sqrt(static_cast<double>(fit.points) / static_cast<double>(preparation.rows));
  std::vector<std::string>& warnings = out.warnings;
  warnings.insert(warnings.end(), preparation.notes.begin(), preparation.notes.end());
  if (!preparation.doubt.empty() && fit.rms > kDoubted * preparation.noise * averaged) {
    warnings.push_back(preparation.doubt);
    if (!nearer_law.empty()) out.poor = no_tissue_text(fit, preparation.doubt, nearer_law);
  }
  if (preparation.rows > fit.points) {
    warnings.push_back(fmt::format("{} rows were averaged to {} points", preparation.rows, fit.points));
  }
  if (const std::string poor = poor_fit({&fit, 1}, {}); !poor.empty()) warnings.push_back(poor);
  const std::vector<double> left = plain_residuals(problem, part, fit.shared, fit.own);
  const double limit = 1.5 * problem.loss_scale;  // six standard deviations
  const auto outliers =
      std::count_if(left.begin(), left.end(), [limit](double r) { return std::abs(r) > limit; });
  if (outliers > 0 && problem.loss_scale > 1e-4) {
    warnings.push_back(fmt::format("{}{} far off the curve and hardly counted (Cauchy's loss)", outliers,
                                   outliers == 1 ? " point lies" : " points lie"));
  }
  if (fit.layers_reached < 2) {
    warnings.emplace_back("the data stay within the first layer: they do not determine beta and q");
  }
  if (autocorrelated(optima, fit)) {
    warnings.push_back(
        fmt::format("residuals are autocorrelated, so {} points count as {} in the intervals: the law "
                    "does not fit the curve's shape everywhere",
                    fit.points, brief(optima.effective, 3)));
  }
}

constexpr double kVisible = 0.02;          // of the force: smaller differences are not worth a warning
constexpr double kErrors = 4.0;            // standard errors above which a difference is no noise
constexpr double kDeeperHalf = 0.5;        // of the depth
constexpr double kNearer = 0.5;            // of this law's error: the other law is worth a warning
constexpr double kPoorLateContact = 0.45;  // bound of the excess above which over 20 % are likely: it is
                                           // about twice the excess (Hertz: 31 for 15 %, layers: 73 for 39 %)
constexpr std::size_t kWindows = 20;       // over the points of a curve

std::string mm(double metres) { return brief(metres / kMillimetre, 3) + " mm"; }

/// Standard deviation [N] of a point as it was fitted, by the noise of the first rows.
double noise_of(const Part& part) {
  const Preparation& preparation = part.specimen->preparation;
  const double rows = std::max<double>(1.0, static_cast<double>(preparation.rows));
  return preparation.noise * std::sqrt(static_cast<double>(part.specimen->size()) / rows);
}

/// Where the mean of some neighbours differs most from the fit, relative to the force there.
struct Difference {
  double share = 0.0;     // fitted minus measured, over measured
  double at = 0.0;        // m, displacement
  double measured = 0.0;  // N, above the sensor's zero
};

std::optional<Difference> largest_difference(const Problem& problem, const SpecimenFit& fit) {
  const Part& part = problem.parts.front();
  const Specimen curve = part.specimen->time.empty() ? by_displacement(*part.specimen) : *part.specimen;
  const double contact = fit.own[0] * part.ranges.displacement;
  const double zero = fit.own[1] * part.ranges.force;
  const double deepest = part.ranges.lowest_displacement + part.ranges.displacement - contact;
  std::vector<double> force(curve.size());
  predict(curve, part.ranges, problem.settings, fit.shared, fit.own, force);
  const std::size_t window = std::max<std::size_t>(3, curve.size() / kWindows);
  const double error = kErrors * noise_of(part) / std::sqrt(static_cast<double>(window));
  std::optional<Difference> largest;
  for (std::size_t begin = 0; begin + window <= curve.size(); begin += std::max<std::size_t>(1, window / 3)) {
    double at = 0.0;
    double measured = 0.0;
    double difference = 0.0;
    for (std::size_t i = begin; i < begin + window; ++i) {
      at += curve.displacement[i] / static_cast<double>(window);
      measured += (curve.force[i] - zero) / static_cast<double>(window);
      difference += (force[i] - curve.force[i]) / static_cast<double>(window);
    }
    if (at - contact < kDeeperHalf * deepest || !(std::abs(difference) > error)) continue;
    const double share = difference / std::max(std::abs(measured), 0.01 * part.ranges.force);
    if (!largest || std::abs(share) > std::abs(largest->share)) largest = Difference{share, at, measured};
  }
  return largest;
}

/// How far [m] the fitted first contact lies beyond the place from which the measured force rises out of its
/// noise; 0 where it does not. A law that cannot follow a curve may leave its beginning to the sensor's zero.
double late_contact(const Part& part, const SpecimenFit& fit) {
  constexpr std::size_t kFewest = 5;  // rows
  const double contact = fit.own[0] * part.ranges.displacement;
  double n = 0.0;
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;  // sums over displacement and force
  for (std::size_t i = 0; i < part.specimen->size(); ++i) {
    const double way = part.specimen->displacement[i] - part.ranges.lowest_displacement;
    if (way > contact - part.ranges.lowest_displacement) continue;
    n += 1.0;
    x += way;
    y += part.specimen->force[i];
    xx += way * way;
    xy += way * part.specimen->force[i];
  }
  if (n < static_cast<double>(kFewest)) return 0.0;
  const double spread = xx - x * x / n;
  const double slope = (xy - x * y / n) / spread;
  if (!(spread > 0.0) || !(slope > kErrors * noise_of(part) / std::sqrt(spread))) return 0.0;
  double from = flat_until(*part.specimen, part.ranges);
  if (part.specimen->preparation.contact) from = std::max(from, *part.specimen->preparation.contact);
  return std::max(0.0, contact - from);
}

/// How much [a fraction] the law's force over the deeper half of the depth is off when first contact lies
/// this much earlier than fitted [m; negative: later], and the depth [m] where it is most.
std::pair<double, double> off_by_contact(const Problem& problem, const SpecimenFit& fit, double earlier) {
  const Part& part = problem.parts.front();
  const double contact = fit.own[0] * part.ranges.displacement;
  const double deepest = part.ranges.lowest_displacement + part.ranges.displacement - contact;
  std::pair<double, double> largest{0.0, 0.0};
  for (const double share : {0.5, 0.75, 1.0}) {
    const double depth = share * (deepest + std::min(0.0, earlier));
    const Specimen depths{"", {}, {depth, std::max(0.0, depth - earlier)}, {0.0, 0.0}};
    std::vector<double> force(depths.size());
    predict(depths, part.ranges, problem.settings, fit.shared, Point(kOwnParameters, 0.0), force);
    if (!(force[1] > 0.0)) continue;
    const double off = force[0] / force[1] - 1.0;
    if (std::abs(off) > std::abs(largest.first)) largest = {off, depth};
  }
  return largest;
}

/// Error of the other law, as a fraction of the force range.
double error_of_other_law(const Problem& problem) {
  Settings settings = problem.settings;
  settings.law = settings.law == model::LawKind::kSmooth ? model::LawKind::kLayered : model::LawKind::kSmooth;
  constexpr std::size_t kPoints = 200;
  constexpr std::size_t kStartsEach = 2;  // per value of L_1
  const Specimen few = thinned(*problem.parts.front().specimen, kPoints);
  const Problem other = make_problem(settings, 0, {make_part(few)});
  const LocalOptima optima = run_multistart(other, multistart_points(other, kStartsEach));
  const Solution& best = optima.all.front();
  double squares = 0.0;
  for (const double r : plain_residuals(other, other.parts.front(), best.shared, best.own.front()))
    squares += r * r;
  return std::sqrt(squares / static_cast<double>(few.size()));
}

std::string poor_text(const SpecimenFit& fit, const std::string& what) {
  return fmt::format("the fit of specimen {} is wrong by over {}: {}", fit.name, percent(kPoorFit, 0), what);
}

/// First rows without a rise, which the fit takes for tissue: they may be motion without contact. Where the
/// sensor is not tared either, nothing shows how far the tool is in.
/// @return why no tissue may come from them if the other law is much nearer; empty: one may
std::string add_flat_rows(const Problem& problem, const SpecimenFit& fit, Misfit& out) {
  constexpr double kLongFlat = 0.15;  // of the range of displacement
  constexpr double kPoorFlat = 0.7;   // of the force, with a tared sensor
  const Part& part = problem.parts.front();
  const double contact = fit.own[0] * part.ranges.displacement;
  const double flat = flat_until(*part.specimen, part.ranges);
  if (part.specimen->preparation.contact ||
      !(flat - part.ranges.lowest_displacement > kLongFlat * part.ranges.displacement))
    return {};
  const auto [off, depth] = off_by_contact(problem, fit, std::min(0.0, contact - flat));
  if (!(-off > kVisible)) return {};
  const std::string text = fmt::format(
      "the force does not rise out of the noise before {}, and the law puts first contact at {}: if the tool "
      "touches at {}, the force {} below contact is {} too low; cut off rows without contact, and count "
      "displacement from contact; if the rows are tissue, its first layer is hardly visible",
      mm(flat), mm(contact), mm(flat), mm(depth), percent(-off, 0));
  out.warnings.push_back(text);
  const bool untared = part.specimen->preparation.zero != 0.0;
  if (-off > (untared ? kPoorFit : kPoorFlat) && out.poor.empty())
    out.poor = untared ? poor_text(fit, text + ", and tare the sensor") : no_tissue_text(fit, text, "");
  return -off > kPoorFit ? no_tissue_text(fit, text, "") : "";
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

Misfit warnings_of(const LocalOptima& optima, const std::vector<Point>& points, const Curvature& curvature,
                   const SpecimenFit& fit, const std::string& nearer_law) {
  Misfit out;
  add_data(optima, fit, nearer_law, out);
  add_uncertainty(optima, points, fit, nearer_law, out);
  add_start_at_depth(optima.problem, fit, out.warnings);
  add_undetermined(identifiability_of(optima, points), fit, out.warnings);
  for (std::string& warning : correlated_warnings(curvature.correlations, labels(fit.terms))) {
    out.warnings.push_back(std::move(warning));
  }
  add_wide_law(fit, optima.problem.parts.front(), out.warnings);
  return out;
}

Misfit misfit_of(const LocalOptima& optima, const SpecimenFit& fit) {
  const Problem& problem = optima.problem;
  const Part& part = problem.parts.front();
  Misfit out;
  if (const auto found = largest_difference(problem, fit); found && std::abs(found->share) > kVisible) {
    const std::string text = fmt::format(
        "at {} the fitted force is {} too {}: measured are {} N above the sensor's zero", mm(found->at),
        percent(std::abs(found->share), 0), found->share > 0.0 ? "high" : "low", brief(found->measured, 3));
    out.warnings.push_back(text + ", and noise does not explain it");
    if (std::abs(found->share) > kPoorFit) out.poor = poor_text(fit, text);
  }
  if (const double late = late_contact(part, fit); late > 0.0) {
    const auto [excess, depth] = off_by_contact(problem, fit, late);
    const double contact = fit.own[0] * part.ranges.displacement;
    const std::string text = fmt::format(
        "the force rises from {} on, but the law puts first contact at {}: its force {} below contact may be "
        "{} too high or more",
        mm(contact - late), mm(contact), mm(depth), percent(excess, 0));
    if (excess > kVisible) out.warnings.push_back(text);
    if (excess > kPoorLateContact && out.poor.empty()) out.poor = poor_text(fit, text);
  }
  const std::string flat = add_flat_rows(problem, fit, out);
  if (out.warnings.empty() || problem.terms > 0) return out;
  const double other = error_of_other_law(problem);
  if (!(other < kNearer * fit.nrmse)) return out;
  const char* const name = fit.law == model::LawKind::kSmooth ? "layered" : "smooth";
  out.nearer_law =
      fmt::format("the {} law leaves {} of the force range where this one leaves {}: fit --law {}", name,
                  percent(other, 2), percent(fit.nrmse, 2), name);
  out.warnings.push_back(out.nearer_law);
  if (out.poor.empty()) out.poor = flat;
  if (!out.poor.empty()) out.poor += "; " + out.nearer_law;
  return out;
}

}  // namespace palpate::identify
