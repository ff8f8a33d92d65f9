#include "fit/identify/loading.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/base/text.h"
#include "palpate/units.h"

#include "fit/identify/least_squares.h"

namespace palpate::identify {
namespace {

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
  if (phase == Phase::kLoading) found.all.push_back({first, high});
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

std::string in_mm(double metres) { return brief(metres / kMillimetre, 3) + " mm"; }

constexpr std::size_t kFewestHeld = 5;  // rows

/// Leaves out rows at the end in which the displacement stays while the force changes: without relaxation no
/// law describes them.
void leave_out_hold(Specimen& used, const Ranges& ranges) {
  constexpr double kStill = 0.01;     // of the range of displacement
  constexpr double kReached = 0.002;  // of it: where the hold begins
  constexpr double kLonger = 5.0;     // times the rows that the motion before takes for as much
  constexpr double kChange = 0.05;    // of the range of force
  const std::vector<double>& at = used.displacement;
  const double highest = ranges.lowest_displacement + ranges.displacement;
  std::size_t held = used.size();
  while (held > 0 && at[held - 1] >= highest - kStill * ranges.displacement) --held;
  std::size_t before = held;
  while (before > 0 && at[before - 1] >= highest - 2.0 * kStill * ranges.displacement &&
         at[before - 1] < highest - kStill * ranges.displacement) {
    --before;
  }
  const std::size_t rows = used.size() - held;
  if (held < kFewestPoints || rows <= kFewestHeld ||
      static_cast<double>(rows) <= kLonger * static_cast<double>(std::max<std::size_t>(1, held - before))) {
    return;
  }
  // The hold may be below the largest displacement, which a ramp can overshoot.
  const auto hold = at.begin() + static_cast<std::ptrdiff_t>(held);
  const double held_at = *std::max_element(hold, at.end());
  const auto first =
      static_cast<std::size_t>(std::find_if(hold, at.end(),
                                            [enough = held_at - kReached * ranges.displacement](double one) {
                                              return one >= enough;
                                            }) -
                               at.begin());
  const double from = used.force[first];
  const double to = used.force.back();
  if (!(std::abs(to - from) > kChange * ranges.force)) return;
  used.preparation.notes.push_back(fmt::format(
      "the displacement stays at {} from row {} of {} on while the force {} from {} to {} N: the rows after "
      "it are left out{}",
      in_mm(held_at), first + 1, used.size(), to < from ? "falls" : "rises", brief(from, 3), brief(to, 3),
      to < from ? " (--relaxation fits all; it needs time_s)"
                : "; is that the displacement sensor's limit?"));
  used = rows_of(used, {0, first});
}

/// Leaves out rows at the end in which the force stays while the displacement rises: no tissue does that, but
/// a sensor at its limit, a slip and a puncture do.
void leave_out_plateau(Specimen& used, const Ranges& ranges) {
  constexpr double kBand = 4.0;         // standard deviations of the noise below the plateau
  constexpr double kRiseBefore = 10.0;  // of these, over as much displacement before
  constexpr double kLeast = 0.02;       // of the range of force: the least such rise
  constexpr double kShortest = 0.04;    // of the range of displacement
  constexpr std::size_t kFewest = 8;    // rows
  if (used.size() < 3 * kFewest) return;
  const Specimen sorted = by_displacement(used);
  std::vector<double> second_differences;
  for (std::size_t i = 1; i + 1 < sorted.size(); ++i) {
    second_differences.push_back(sorted.force[i - 1] - 2.0 * sorted.force[i] + sorted.force[i + 1]);
  }
  const double noise =
      std::max(normalized_mad(std::move(second_differences)) / std::sqrt(6.0), 1e-4 * ranges.force);
  const double level = median(
      std::vector<double>(sorted.force.end() - static_cast<std::ptrdiff_t>(kFewest), sorted.force.end()));
  std::size_t first = sorted.size();
  while (first > 0 && std::abs(sorted.force[first - 1] - level) <= kBand * noise) --first;
  if (first < kFewestPoints || sorted.size() - first < kFewest) return;
  const double width = sorted.displacement.back() - sorted.displacement[first];
  const double start = sorted.displacement[first] - width;
  if (width < kShortest * ranges.displacement) return;
  std::size_t before = first;
  while (before > 0 && sorted.displacement[before - 1] >= start) --before;
  const double rise = level - sorted.force[before];
  if (!(rise > std::max(kRiseBefore * noise, kLeast * ranges.force))) return;
  const double limit = sorted.displacement[first];
  used.preparation.notes.push_back(fmt::format(
      "the force stays at {} N from {} to {}, where it rose before: these {} rows are left out. Is that the "
      "sensor's limit, a slip or a puncture?",
      brief(level, 3), in_mm(limit), in_mm(sorted.displacement.back()), sorted.size() - first));
  Specimen kept = used;
  kept.time.clear();
  kept.displacement.clear();
  kept.force.clear();
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used.displacement[i] >= limit) continue;
    if (!used.time.empty()) kept.time.push_back(used.time[i]);
    kept.displacement.push_back(used.displacement[i]);
    kept.force.push_back(used.force[i]);
  }
  used = std::move(kept);
}

}  // namespace

Specimen whole_loading(const Specimen& specimen) {
  const Ranges ranges = ranges_of(specimen);
  constexpr double kWhole = 0.8;  // of the range of displacement
  const Loadings loadings = loadings_of(specimen, ranges);
  Specimen used = specimen;
  if (!loadings.has_unloading) return used;
  if (loadings.all.empty() && specimen.time.empty()) {
    used.preparation.notes.emplace_back(
        "the displacement only decreases, and there is no time_s: taken as a loading that is sorted from "
        "deep "
        "to shallow. The unloading of a loop looks the same; its force is lower, and so would be the "
        "tissue's");
    return used;
  }
  for (std::size_t cycle = loadings.all.size(); cycle > 0; --cycle) {
    const Loading& loading = loadings.all[cycle - 1];
    const double rise = specimen.displacement[loading.last] - specimen.displacement[loading.first];
    if (loading.last - loading.first + 1 < kFewestPoints || rise < kWhole * ranges.displacement) continue;
    used = rows_of(specimen, loading);
    used.preparation.notes.push_back(fmt::format(
        "the displacement decreases again: of {} rows {} to {} are fitted, the {}; the other rows are left "
        "out (--relaxation fits all)",
        specimen.size(), loading.first + 1, loading.last + 1,
        loadings.all.size() == 1 ? "loading"
                                 : fmt::format("loading of cycle {} of {}", cycle, loadings.all.size())));
    return used;
  }
  used.preparation.notes.push_back(fmt::format(
      "the displacement decreases, and no loading has {} rows over 80 % of the range: all rows are fitted as "
      "one curve, which is right only without hysteresis",
      kFewestPoints));
  return used;
}

Specimen last_loading(const Specimen& specimen) {
  Specimen used = whole_loading(specimen);
  leave_out_hold(used, ranges_of(used));
  leave_out_plateau(used, ranges_of(used));
  return used;
}

Specimen first_loading(const Specimen& specimen) {
  const Loadings loadings = loadings_of(specimen, ranges_of(specimen));
  if (!loadings.has_unloading || loadings.all.empty()) return specimen;
  return rows_of(specimen, loadings.all.front());
}

}  // namespace palpate::identify
