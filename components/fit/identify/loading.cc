#include "fit/identify/loading.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/base/text.h"
#include "palpate/error.h"
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

/// Rows at the end of a loading in which the force stays while the displacement rises: no tissue does that,
/// but a sensor at its limit, a slip and a puncture do.
struct Plateau {
  double level = 0.0;  // N
  double from = 0.0;   // m, displacement
  double to = 0.0;
  std::size_t rows = 0;
};

std::optional<Plateau> plateau_of(const Specimen& loading, const Ranges& ranges) {
  constexpr double kBand = 4.0;         // standard deviations of the noise below the plateau
  constexpr double kRiseBefore = 10.0;  // of these, over as much displacement before
  constexpr double kLeast = 0.02;       // of the range of force: the least such rise
  constexpr double kShortest = 0.04;    // of the range of displacement
  constexpr std::size_t kFewest = 8;    // rows
  if (loading.size() < 3 * kFewest) return std::nullopt;
  const Specimen sorted = by_displacement(loading);
  const double noise = std::max(noise_of_rows(sorted.force), 1e-4 * ranges.force);
  const double level = median(
      std::vector<double>(sorted.force.end() - static_cast<std::ptrdiff_t>(kFewest), sorted.force.end()));
  std::size_t first = sorted.size();
  while (first > 0 && std::abs(sorted.force[first - 1] - level) <= kBand * noise) --first;
  if (first < kFewestPoints || sorted.size() - first < kFewest) return std::nullopt;
  const double width = sorted.displacement.back() - sorted.displacement[first];
  const double start = sorted.displacement[first] - width;
  if (width < kShortest * ranges.displacement) return std::nullopt;
  std::size_t before = first;
  while (before > 0 && sorted.displacement[before - 1] >= start) --before;
  const double rise = level - sorted.force[before];
  if (!(rise > std::max(kRiseBefore * noise, kLeast * ranges.force))) return std::nullopt;
  return Plateau{level, sorted.displacement[first], sorted.displacement.back(), sorted.size() - first};
}

void leave_out_plateau(Specimen& used, const Ranges& ranges) {
  const std::optional<Plateau> plateau = plateau_of(used, ranges);
  if (!plateau) return;
  used.preparation.notes.push_back(fmt::format(
      "the force stays at {} N from {} to {}, where it rose before: these {} rows are left out. Is that the "
      "sensor's limit, a slip or a puncture?",
      brief(plateau->level, 3), in_mm(plateau->from), in_mm(plateau->to), plateau->rows));
  Specimen kept = used;
  kept.time.clear();
  kept.displacement.clear();
  kept.force.clear();
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used.displacement[i] >= plateau->from) continue;
    if (!used.time.empty()) kept.time.push_back(used.time[i]);
    kept.displacement.push_back(used.displacement[i]);
    kept.force.push_back(used.force[i]);
  }
  used = std::move(kept);
}

/// The rows up to where the first loading comes near its largest displacement.
Specimen ramp_of(const Specimen& specimen, const Ranges& ranges) {
  constexpr double kReached = 0.005;  // of the range of displacement
  const Specimen loading = first_loading(specimen);
  const std::vector<double>& at = loading.displacement;
  const double enough = *std::max_element(at.begin(), at.end()) - kReached * ranges.displacement;
  const auto last = std::find_if(at.begin(), at.end(), [enough](double one) { return one >= enough; });
  return rows_of(loading, {0, static_cast<std::size_t>(last - at.begin())});
}

/// Whether the displacement rises over a plateau as fast as over as much displacement before: under a
/// constant load it creeps ever more slowly.
bool rises_on(const Specimen& ramp, const Plateau& plateau) {
  constexpr double kSlower = 3.0;  // times
  const auto time_at = [&ramp](double displacement) {
    const auto row = std::find_if(ramp.displacement.begin(), ramp.displacement.end(),
                                  [displacement](double at) { return at >= displacement; });
    return ramp.time[static_cast<std::size_t>(row - ramp.displacement.begin())];
  };
  const double width = plateau.to - plateau.from;
  const double from = time_at(plateau.from);
  return time_at(plateau.to) - from < kSlower * (from - time_at(plateau.from - width));
}

/// Equal forces of successive rows.
struct EqualRows {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// Equal rows beside rows that change from one to the next, which no resolution of a sensor explains: at the
/// largest force, before rows that change, or in a hold, after such rows.
std::optional<EqualRows> frozen_rows(const Specimen& specimen, const Ranges& ranges) {
  constexpr std::size_t kFewest = 8;  // equal rows, and rows beside them
  constexpr double kStill = 0.01;     // of the range of displacement
  const std::vector<double>& force = specimen.force;
  const double most = *std::max_element(force.begin(), force.end());
  const auto changes = [&force](std::size_t first) {
    const auto from = force.begin() + static_cast<std::ptrdiff_t>(first);
    return std::set<double>(from, from + kFewest).size() + 1 >= kFewest;
  };
  for (std::size_t first = 0, end = 0; first < force.size(); first = end) {
    while (end < force.size() && force[end] == force[first]) ++end;
    if (end - first < kFewest) continue;
    const bool cut_off = force[first] == most && end + kFewest <= force.size() && changes(end);
    const bool stops = first >= kFewest &&
                       std::abs(specimen.displacement[first] - specimen.displacement[first - kFewest]) <
                           kStill * ranges.displacement &&
                       changes(first - kFewest);
    if (cut_off || stops) return EqualRows{first, end - first};
  }
  return std::nullopt;
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
        "deep to shallow. The unloading of a loop looks the same; its force is lower, and so would be the "
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

double noise_of_rows(const std::vector<double>& force) {
  std::vector<double> second_differences;
  for (std::size_t i = 1; i + 1 < force.size(); ++i)
    second_differences.push_back(force[i - 1] - 2.0 * force[i] + force[i + 1]);
  return normalized_mad(std::move(second_differences)) / std::sqrt(6.0);
}

Specimen last_loading(const Specimen& specimen) {
  Specimen used = whole_loading(specimen);
  leave_out_hold(used, ranges_of(used));
  leave_out_plateau(used, ranges_of(used));
  return used;
}

void require_unsaturated(const Specimen& specimen, const std::string& where) {
  constexpr const char* kRemedy =
      "is that the sensor's limit? A fit with --relaxation would take it for the tissue's force: press less "
      "deep, or use a sensor for larger forces";
  const Ranges ranges = ranges_of(specimen);
  const Specimen ramp = ramp_of(specimen, ranges);
  if (const std::optional<Plateau> plateau = plateau_of(ramp, ranges); plateau && rises_on(ramp, *plateau)) {
    throw InputError(fmt::format("{}: force_N stays at {} N from {} to {} while the displacement rises: {}",
                                 where, brief(plateau->level, 3), in_mm(plateau->from), in_mm(plateau->to),
                                 kRemedy));
  }
  if (const std::optional<EqualRows> rows = frozen_rows(specimen, ranges)) {
    throw InputError(
        fmt::format("{}: force_N is {} in {} rows from row {} on, where the force of its neighbours changes "
                    "from row to row: {}",
                    where, brief(specimen.force[rows->first], 3), rows->count, rows->first + 1, kRemedy));
  }
}

Specimen leave_out_start(const Specimen& specimen) {
  constexpr double kMost = 0.1;       // of the rows
  constexpr std::size_t kAfter = 10;  // rows that follow
  constexpr double kSteeper = 5.0;    // times the largest step of these
  constexpr double kLeast = 0.02;     // of the range of force of the other rows
  const std::vector<double>& force = specimen.force;
  const std::vector<double>& at = specimen.displacement;
  const auto largest_step = [](const std::vector<double>& values, std::size_t from) {
    double largest = 0.0;
    for (std::size_t i = from; i < from + kAfter; ++i)
      largest = std::max(largest, std::abs(values[i + 1] - values[i]));
    return largest;
  };
  const auto most = static_cast<std::size_t>(kMost * static_cast<double>(specimen.size()));
  for (std::size_t first = most; first > 0; --first) {
    if (first + kAfter + kFewestPoints > specimen.size()) continue;
    const double jump = std::abs(force[first] - force[first - 1]);
    if (!(jump > kSteeper * largest_step(force, first)) ||
        std::abs(at[first] - at[first - 1]) > 2.0 * largest_step(at, first))
      continue;
    Specimen used = rows_of(specimen, {first, specimen.size() - 1});
    if (!(jump > kLeast * ranges_of(used).force)) continue;
    used.preparation.notes.push_back(
        fmt::format("the force jumps from {} to {} N between row {} and the next, and no row after them "
                    "does: the first {} left out, as of a sensor or a recorder that starts",
                    brief(force[first - 1], 3), brief(force[first], 3), first,
                    first == 1 ? "row is" : fmt::format("{} rows are", first)));
    return used;
  }
  return specimen;
}

Specimen first_loading(const Specimen& specimen) {
  const Loadings loadings = loadings_of(specimen, ranges_of(specimen));
  if (!loadings.has_unloading || loadings.all.empty()) return specimen;
  return rows_of(specimen, loadings.all.front());
}

}  // namespace palpate::identify
