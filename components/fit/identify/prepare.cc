// What is done to the rows of a specimen before a law is fitted to them: loops are reduced to one loading,
// and the sensor's zero, drift or tilt is subtracted (docs/fitting.md, "Before the fit").
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/core.h>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "palpate/identify.h"
#include "palpate/units.h"

#include "fit/identify/least_squares.h"
#include "fit/identify/loading.h"
#include "fit/identify/local_optima.h"
#include "fit/identify/start.h"

namespace palpate::identify {
namespace {

constexpr std::size_t kMaxUntimedPoints = 1000;  // per specimen, without relaxation
constexpr std::size_t kMaxTimedPoints = 2000;    // per specimen, with relaxation, whose fast terms need
                                                 // dense samples
constexpr std::size_t kMaxPooledPoints = 400;    // per specimen, in the pooled fit

std::string millimetres(double metres) { return brief(metres / kMillimetre, 3) + " mm"; }

/// A force as a part of the range of force: "9 times the range of force", "16 % of the range of force".
std::string of_range(double force, const Ranges& ranges) {
  const double share = std::abs(force) / ranges.force;
  return (share < 1.0 ? percent(share, 0) : brief(share, 2) + " times") +
         (share < 1.0 ? " of the range of force" : " the range of force");
}

std::string slope_text(double slope) { return brief(slope, 3) + " mN/mm"; }  // N/m equals mN/mm

constexpr double kWorthwhile = 0.005;  // of the force range: a smaller zero or drift is left to the fit
constexpr double kLate = 0.2;  // of the displacement range: the fit's own search finds an earlier contact

bool is_zero(double force, double error, const Ranges& ranges) {
  return !(std::abs(force) > std::max(kStartErrors * error, kWorthwhile * ranges.force));
}

/// Depth [m] of the first row where displacement counts from contact; 0 where it does not.
double first_depth(const Ranges& ranges) {
  return own_prior(ranges).first_contact == 0.0 ? std::max(0.0, ranges.lowest_displacement) : 0.0;
}

/// Takes the reading of the first rows as the sensor's zero, as far as a contact at displacement 0 does not
/// explain it: a tissue that stiffens carries at most its slope times the depth.
void use_first_row(const Start& start, const Ranges& ranges, Preparation& out) {
  const double steepest = std::max(0.0, start.slope + 2.0 * start.slope_error);
  double zero = start.force;
  if (zero > 0.0) zero = std::max(0.0, zero - steepest * first_depth(ranges));
  if (is_zero(zero, start.force_error, ranges)) return;
  out.zero = zero;
  out.zero_at = ranges.lowest_displacement;
  if (zero < 0.0) {
    out.notes.push_back(fmt::format(
        "the first rows read {} N, {}: no tissue gives that, so it is subtracted as the sensor's zero",
        brief(zero, 3), of_range(zero, ranges)));
    return;
  }
  out.notes.push_back(fmt::format(
      "the first row reads {} N, {}, and no flat rows precede it: subtracted as the sensor's zero, because "
      "displacement counts from contact. If the tool touched before the first row, this tissue is wrong: "
      "tare the sensor, or start 1 mm above the tissue",
      brief(zero, 3), of_range(zero, ranges)));
}

std::string line_text(const Start& start) {
  return fmt::format(
      "the {} rows before {} follow a {} of {} that ends at a kink", start.lead_rows, millimetres(start.kink),
      start.lead_curve != 0.0 ? "curve with a slope" : "straight line", slope_text(start.lead_slope));
}

/// Whether the lead drifts so much that it matters to the fit.
bool drifts(const Start& start, const Ranges& ranges) {
  return start.lead_curve != 0.0 ||
         std::abs(start.lead_slope) * ranges.displacement > kWorthwhile * ranges.force;
}

/// Says how far off a drift may be at the deepest row, when the rows before contact are continued to there:
/// by twice the standard error of their curvature. No tissue comes from a curve that is off by more than
/// kVisible, or from one that bends upwards, as the force of a soft tissue does.
void doubt_drift(const Start& start, const Ranges& ranges, Preparation& out) {
  constexpr double kVisible = 0.02;  // of the range of force
  const double lead = start.kink - ranges.lowest_displacement;
  const double way = ranges.displacement - 0.5 * lead;  // from the middle of the lead
  const double error = 2.0 * start.curve_error * way * way;
  constexpr const char* kRemedy = "tare it, wait until it is warm, or start further above the tissue";
  std::string text;
  if (start.lead_curve > 0.0 && start.lead_slope > 0.0) {
    text = fmt::format(
        "the rows before {} bend upwards: a sensor that drifts does so, and a soft tissue looks alike: {}",
        millimetres(start.kink), kRemedy);
  } else if (error > kVisible * ranges.force) {
    text = fmt::format(
        "the force at the deepest row is uncertain by {}, because the sensor drifts and {} without contact "
        "do not show how it goes on: {}",
        percent(error / ranges.force, 0), millimetres(lead), kRemedy);
  } else {
    return;
  }
  out.notes.push_back(text);
  if (start.lead_curve != 0.0) out.poor = text;
}

/// The rows before a kink as motion without contact, where that matters to the fit; nothing otherwise.
std::optional<Preparation> with_lead(const Start& start, const Ranges& ranges, Preparation out) {
  const bool late = start.kink - ranges.lowest_displacement > kLate * ranges.displacement;
  const bool sloped = drifts(start, ranges);
  if (start.lead_rows == 0) return std::nullopt;
  if (!sloped && !late && is_zero(start.lead_force, start.lead_error, ranges)) return std::nullopt;
  out.contact = start.kink;
  out.contact_error = start.kink_error;
  out.zero = start.lead_force;
  out.zero_at = start.kink;
  if (sloped) {
    out.zero_slope = start.lead_slope;
    out.zero_curve = start.lead_curve;
    out.notes.push_back(
        line_text(start) +
        ": taken as a tilted or drifting sensor before contact, and subtracted from all rows" +
        (start.lead_slope > 0.0 ? "; if it is tissue, fit --law layered, whose layers have kinks" : ""));
    doubt_drift(start, ranges, out);
  } else {
    out.notes.push_back(fmt::format(
        "the {} rows before {} read {} N on average: taken as motion without contact, and subtracted as the "
        "sensor's zero",
        start.lead_rows, millimetres(start.kink), brief(start.lead_force, 4)));
  }
  return out;
}

/// A curve without contact before its first row.
Preparation without_lead(const Start& start, const Ranges& ranges, const Settings& settings,
                         Preparation out) {
  out.contact_error = start.contact_error;
  use_first_row(start, ranges, out);
  if (start.lead_rows == 0 || !drifts(start, ranges)) return out;
  const std::string question = fmt::format(
      ": a tilted or drifting sensor before contact looks alike. If the tool touches at {}, subtract {} N + "
      "{} x displacement from all forces",
      millimetres(start.kink), brief(start.lead_force - start.lead_slope * start.kink, 3),
      slope_text(start.lead_slope));
  if (start.lead_slope < 0.0 || settings.relaxation) {
    out.notes.push_back(line_text(start) + question);
  } else {
    out.doubt =
        line_text(start) + ", which is fitted as tissue, but the law does not follow the rest" + question;
  }
  return out;
}

void subtract_baseline(Specimen& specimen) {
  for (std::size_t i = 0; i < specimen.size(); ++i)
    specimen.force[i] -= specimen.preparation.baseline(specimen.displacement[i]);
}

/// RMS error [N] of a quick fit without relaxation to the rows of a loading.
struct QuickFit {
  double rms = 0.0;
  double points = 0.0;
};

QuickFit quick_fit(const Specimen& loading, Settings settings, const Preparation& preparation) {
  constexpr std::size_t kPoints = 120;
  constexpr std::size_t kStartsEach = 2;  // per value of L_1
  settings.relaxation = false;
  Specimen used = loading;
  used.time.clear();
  used.preparation = preparation;
  subtract_baseline(used);
  used = thinned(used, kPoints);
  const Problem problem = make_problem(settings, 0, {make_part(used)});
  const LocalOptima optima = run_multistart(problem, multistart_points(problem, kStartsEach));
  const Solution& best = optima.all.front();
  const Part& part = problem.parts.front();
  double squares = 0.0;
  for (const double r : plain_residuals(problem, part, best.shared, best.own.front())) squares += r * r;
  const auto points = static_cast<double>(used.size());
  return {std::max(std::sqrt(squares / points), 1e-4) * part.ranges.force, points};
}

/// Whether the law fits the rest of a curve clearly better when its lead is no tissue; as well, for a flat
/// lead that does not move contact beyond the fit's own search, and that a contact at displacement 0 does not
/// explain.
bool fits_better_with_lead(const Specimen& loading, const Settings& settings, const Preparation& without,
                           const Preparation& with) {
  constexpr double kFollows = 1.5;  // of the noise: a rising lead may be tissue, so the rest must fit
  constexpr double kAsWell = 1.01;
  const QuickFit as_tissue = quick_fit(loading, settings, without);
  const QuickFit as_lead = quick_fit(loading, settings, with);
  const Ranges ranges = ranges_of(loading);
  const bool late = *with.contact - ranges.lowest_displacement > kLate * ranges.displacement;
  const bool explained = with.zero > 0.0 && without.zero == 0.0 && first_depth(ranges) > 0.0;
  if (!late && !explained && with.zero_slope == 0.0) return as_lead.rms < kAsWell * as_tissue.rms;
  const double averaged = static_cast<double>(loading.size()) / as_lead.points;
  const double noise = without.noise / std::sqrt(averaged);
  if ((with.zero_slope > 0.0 || with.zero_curve != 0.0) && as_lead.rms > kFollows * noise) return false;
  const double unknowns = with.zero_curve != 0.0 ? 3.0 : with.zero_slope != 0.0 ? 2.0 : 1.0;
  return 2.0 * as_lead.points * portable::log(as_tissue.rms / as_lead.rms) >
         kCertain + unknowns * portable::log(as_lead.points);
}

}  // namespace

Specimen prepared(const Specimen& specimen, const Settings& settings) {
  Specimen used = leave_out_start(settings.relaxation ? specimen : last_loading(specimen));
  used.preparation.rows = used.size();
  const Ranges ranges = ranges_of(used);
  const Specimen loading = settings.relaxation ? first_loading(used) : used;
  if (loading.size() < kFewestPoints) return used;
  const Start start = start_of(loading, ranges);
  used.preparation.noise = start.noise;
  const Preparation without = without_lead(start, ranges, settings, used.preparation);
  const std::optional<Preparation> with = with_lead(start, ranges, used.preparation);
  const bool first_layer =
      settings.law == model::LawKind::kLayered && with && with->zero_slope > 0.0 && with->zero_curve == 0.0;
  const bool may_drift = !settings.relaxation || (with && with->zero_slope == 0.0);
  const bool has_lead =
      with && !first_layer && may_drift && fits_better_with_lead(loading, settings, without, *with);
  used.preparation = has_lead ? *with : without;
  subtract_baseline(used);
  return used;
}

Specimen as_fitted(const Specimen& specimen, const Settings& settings) {
  return thinned(prepared(specimen, settings), settings.relaxation ? kMaxTimedPoints : kMaxUntimedPoints);
}

std::vector<Specimen> as_pooled(const std::vector<Specimen>& specimens, const Settings& settings) {
  std::vector<Specimen> pooled;
  for (const Specimen& specimen : specimens) {
    pooled.push_back(thinned(prepared(specimen, settings), kMaxPooledPoints));
  }
  return pooled;
}

}  // namespace palpate::identify
