// What is done to the rows of a specimen before a law is fitted to them: loops are reduced to one loading,
// and the sensor's zero, drift or tilt is subtracted (docs/fitting.md, "Before the fit").
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/identify.h"
#include "palpate/units.h"

#include "fit/identify/least_squares.h"
#include "fit/identify/start.h"

namespace palpate::identify {
namespace {

constexpr std::size_t kMaxUntimedPoints = 1000;  // per specimen, without relaxation
constexpr std::size_t kMaxTimedPoints = 2000;    // per specimen, with relaxation, whose fast terms need
                                                 // dense samples
constexpr std::size_t kMaxPooledPoints = 400;    // per specimen, in the pooled fit

/// First and last row of a loading.
struct Loading {
  std::size_t first = 0;
  std::size_t last = 0;
};

/// Loadings of a specimen, by the order of its rows.
struct Loadings {
  std::vector<Loading> all;
  bool has_unloading = false;
};

/// A change of direction counts when the displacement moves back by a quarter of its range.
Loadings loadings_of(const Specimen& specimen, const Ranges& ranges) {
  constexpr double kTurn = 0.25;  // of the range of displacement
  const double turn = kTurn * ranges.displacement;
  const std::vector<double>& at = specimen.displacement;
  Loadings found;
  enum class Phase { kUnknown, kLoading, kUnloading } phase = Phase::kUnknown;
  std::size_t first = 0;  // of the current loading
  std::size_t low = 0;    // rows of the extremes since the last turn
  std::size_t high = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (at[i] <= at[low]) low = i;
    if (at[i] >= at[high]) high = i;
    if (phase != Phase::kUnloading && at[i] < at[high] - turn) {
      if (phase == Phase::kLoading) found.all.push_back({first, high});
      found.has_unloading = true;
      phase = Phase::kUnloading;
      low = i;
    } else if (phase != Phase::kLoading && at[i] > at[low] + turn) {
      first = phase == Phase::kUnknown ? 0 : low;
      phase = Phase::kLoading;
      high = i;
    }
  }
  if (phase == Phase::kLoading) found.all.push_back({first, at.size() - 1});
  return found;
}

/// The rows of a loading.
Specimen rows_of(const Specimen& specimen, const Loading& loading) {
  Specimen part = specimen;
  for (std::vector<double>* column : {&part.time, &part.displacement, &part.force}) {
    if (column->empty()) continue;
    column->resize(loading.last + 1);
    column->erase(column->begin(), column->begin() + static_cast<std::ptrdiff_t>(loading.first));
  }
  return part;
}

/// The last whole loading of a loop; all rows where the specimen is no loop, or has no whole loading.
Specimen last_loading(const Specimen& specimen, const Ranges& ranges) {
  constexpr double kWhole = 0.8;  // of the range of displacement
  const Loadings loadings = loadings_of(specimen, ranges);
  Specimen used = specimen;
  if (!loadings.has_unloading) return used;
  for (std::size_t cycle = loadings.all.size(); cycle > 0; --cycle) {
    const Loading& loading = loadings.all[cycle - 1];
    const double rise = specimen.displacement[loading.last] - specimen.displacement[loading.first];
    if (loading.last - loading.first + 1 < kFewestPoints || rise < kWhole * ranges.displacement) continue;
    used = rows_of(specimen, loading);
    used.preparation.notes.push_back(fmt::format(
        "the displacement decreases again: of {} rows {} to {} are fitted, the {}; the other rows are left "
        "out "
        "(--relaxation fits all)",
        specimen.size(), loading.first + 1, loading.last + 1,
        loadings.all.size() == 1 ? "loading"
                                 : fmt::format("loading of cycle {} of {}", cycle, loadings.all.size())));
    return used;
  }
  used.preparation.notes.push_back(fmt::format(
      "the displacement decreases again, and no loading has {} rows over 80 % of the way: loading "
      "and unloading are fitted as one curve, which is right only without hysteresis",
      kFewestPoints));
  return used;
}

std::string millimetres(double metres) { return brief(metres / kMillimetre, 3) + " mm"; }

/// A force as a part of the range of force: "9 times the range of force", "16 % of the range of force".
std::string of_range(double force, const Ranges& ranges) {
  const double share = std::abs(force) / ranges.force;
  return (share < 1.0 ? percent(share, 0) : brief(share, 2) + " times") +
         (share < 1.0 ? " of the range of force" : " the range of force");
}

std::string slope_text(double slope) { return brief(slope, 3) + " mN/mm"; }  // N/m equals mN/mm

constexpr double kWorthwhile = 0.005;  // of the force range: a smaller zero or drift is left to the fit
constexpr double kZeroErrors = 4.0;    // standard errors above which a zero differs from 0

bool is_zero(double force, double error, const Ranges& ranges) {
  return !(std::abs(force) > std::max(kZeroErrors * error, kWorthwhile * ranges.force));
}

/// Takes the reading of the first rows as the sensor's zero, as far as a contact at displacement 0 does not
/// explain it: a tissue that stiffens carries at most its slope times the depth.
/// @param force, error, slope reading at the first row, its standard error, and the slope there
void use_first_row(double force, double error, double slope, const Ranges& ranges, Preparation& out) {
  constexpr double kFarStart = 0.25;  // as own_prior()
  const double first = ranges.lowest_displacement;
  const bool counted = std::abs(first) <= kFarStart * ranges.displacement;
  double zero = force;
  if (force > 0.0 && counted) zero = std::max(0.0, force - std::max(0.0, slope * first));
  if (is_zero(zero, error, ranges)) return;
  out.zero = zero;
  out.zero_at = first;
  if (zero < 0.0) {
    out.notes.push_back(fmt::format(
        "the first rows read {} N, {}: no tissue gives that, so it is subtracted as the sensor's zero",
        brief(zero, 3), of_range(zero, ranges)));
    return;
  }
  out.notes.push_back(fmt::format(
      "the first row carries {} N, {}, and no flat rows before contact show the sensor's zero: subtracted as "
      "the zero, because displacement counts from contact. If the tool touched before the first row, this "
      "tissue is wrong: tare the sensor, or start 1 mm above the tissue",
      brief(zero, 3), of_range(zero, ranges)));
}

/// Takes the rows before a kink as motion without contact, where that matters to the fit.
void use_lead(const Start& start, const Ranges& ranges, const Settings& settings, Preparation& out) {
  constexpr double kLate = 0.2;  // of the displacement range: a later contact is outside of the fit's search
  const bool drifts = std::abs(start.slope) * ranges.displacement > kWorthwhile * ranges.force;
  const double first = start.force - start.slope * (start.at - ranges.lowest_displacement);
  const std::string place = millimetres(start.at);
  if (drifts && start.slope > 0.0 && settings.law == model::LawKind::kLayered) {
    use_first_row(first, start.force_error, start.slope, ranges, out);
    out.doubt = fmt::format(
        "the force follows a line of {} to a kink at {}, which is fitted as the first layer, but the law "
        "does not follow the rest: a tilted or drifting sensor before contact looks alike. If the tool "
        "touches at {}, subtract {} N + {} x displacement from all forces",
        slope_text(start.slope), place, place, brief(start.force - start.slope * start.at, 3),
        slope_text(start.slope));
    return;
  }
  const bool late = start.at - ranges.lowest_displacement > kLate * ranges.displacement;
  if (!drifts && !late && is_zero(start.force, start.force_error, ranges)) return;
  const std::string line =
      fmt::format("the {} rows before {} follow a straight line of {} that ends at a kink", start.rows, place,
                  slope_text(start.slope));
  if (drifts && settings.relaxation) {
    use_first_row(first, start.force_error, start.slope, ranges, out);
    out.notes.push_back(
        line +
        ": a sensor that drifts with time or is tilted before contact looks like this, and with "
        "--relaxation it is not subtracted");
    return;
  }
  out.contact = start.at;
  out.zero = start.force;
  out.zero_at = start.at;
  if (!drifts) {
    out.notes.push_back(fmt::format(
        "the {} rows before {} read {} N on average: taken as motion without contact, and subtracted as the "
        "sensor's zero",
        start.rows, place, brief(start.force, 4)));
    return;
  }
  out.zero_slope = start.slope;
  out.notes.push_back(
      line + ": taken as a tilted or drifting sensor before contact, and subtracted from all rows" +
      (start.slope > 0.0 ? "; if it is tissue, fit --law layered, whose layers have kinks" : ""));
}

/// The rows that begin the measurement: with relaxation, of the first loading.
Specimen beginning_of(const Specimen& used, const Ranges& ranges) {
  const Loadings loadings = loadings_of(used, ranges);
  if (!loadings.has_unloading || loadings.all.empty()) return used;
  return rows_of(used, loadings.all.front());
}

}  // namespace

Specimen prepared(const Specimen& specimen, const Settings& settings) {
  const Ranges whole = ranges_of(specimen);
  Specimen used = settings.relaxation ? specimen : last_loading(specimen, whole);
  Preparation& preparation = used.preparation;
  preparation.rows = used.size();
  const Ranges ranges = ranges_of(used);
  const Specimen beginning = settings.relaxation ? beginning_of(used, whole) : used;
  if (beginning.size() < kFewestPoints) return used;
  const Start start = start_of(beginning, ranges);
  preparation.noise = start.noise;
  preparation.contact_error = start.contact_error;
  if (start.has_kink) {
    use_lead(start, ranges, settings, preparation);
  } else {
    use_first_row(start.force, start.force_error, start.slope, ranges, preparation);
    constexpr double kFirst = 0.1;  // of the displacement range
    if (-start.slope * kFirst * ranges.displacement > kWorthwhile * ranges.force) {
      preparation.notes.push_back(fmt::format(
          "the force falls by {} at the first rows, which no tissue does, and not along a line up "
          "to a kink, which could be subtracted: the sensor drifts; record more rows before contact",
          slope_text(-start.slope)));
    }
  }
  for (std::size_t i = 0; i < used.size(); ++i) used.force[i] -= preparation.baseline(used.displacement[i]);
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
