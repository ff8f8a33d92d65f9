#include "fit/identify/misfit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/units.h"

#include "fit/identify/least_squares.h"

namespace palpate::identify {
namespace {

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
void add_flat_rows(const Problem& problem, const SpecimenFit& fit, Misfit& out) {
  constexpr double kLongFlat = 0.15;  // of the range of displacement
  const Part& part = problem.parts.front();
  const double contact = fit.own[0] * part.ranges.displacement;
  const double flat = flat_until(*part.specimen, part.ranges);
  if (part.specimen->preparation.contact ||
      !(flat - part.ranges.lowest_displacement > kLongFlat * part.ranges.displacement))
    return;
  const auto [off, depth] = off_by_contact(problem, fit, std::min(0.0, contact - flat));
  if (!(-off > kVisible)) return;
  const std::string text = fmt::format(
      "the force does not rise out of the noise before {}, and the law puts first contact at {}: if the tool "
      "touches "
      "at {}, the force {} below contact is {} too low; cut off rows without contact, and count displacement "
      "from "
      "contact; if the rows are tissue, its first layer is hardly visible",
      mm(flat), mm(contact), mm(flat), mm(depth), percent(-off, 0));
  out.warnings.push_back(text);
  const bool untared = part.specimen->preparation.zero != 0.0;
  if (untared && -off > kPoorFit && out.poor.empty())
    out.poor = poor_text(fit, text + ", and tare the sensor");
}

}  // namespace

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
        "up "
        "to {} too high",
        mm(contact - late), mm(contact), mm(depth), percent(excess, 0));
    if (excess > kVisible) out.warnings.push_back(text);
    if (excess > kPoorLateContact && out.poor.empty()) out.poor = poor_text(fit, text);
  }
  add_flat_rows(problem, fit, out);
  if (out.warnings.empty() || problem.terms > 0) return out;
  const double other = error_of_other_law(problem);
  if (!(other < kNearer * fit.nrmse)) return out;
  const char* const name = fit.law == model::LawKind::kSmooth ? "layered" : "smooth";
  const std::string advice =
      fmt::format("the {} law leaves {} of the force range where this one leaves {}: fit --law {}", name,
                  percent(other, 2), percent(fit.nrmse, 2), name);
  out.warnings.push_back(advice);
  if (!out.poor.empty()) out.poor += "; " + advice;
  return out;
}

}  // namespace palpate::identify
