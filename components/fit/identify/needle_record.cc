// Records of needles: what is checked before a fit, and where the force falls.
#include "fit/identify/needle_record.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/base/text.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/units.h"

#include "fit/identify/loading.h"
#include "fit/identify/plausible_specimen.h"

namespace palpate::identify {
namespace {

constexpr std::size_t kFewestNeedleRows = 100;
constexpr double kSlowestRows = 0.1;  // s, between rows: a puncture takes 0.04 s
constexpr double kBefore = 15e-3;     // s, whose mean is the force before a fall, and after it
constexpr double kFallen = 50e-3;     // s, in which most of a fall is over
constexpr double kApart = 120e-3;     // s, between falls
constexpr std::size_t kMostFalls = 5;
constexpr double kLeastFall = 0.03;    // of the range of force
constexpr double kFallErrors = 4.0;    // standard errors of the noise
constexpr double kTurned = 0.01;       // of the depth, that still counts as the largest
constexpr double kWithdrawn = 0.25;    // of the depth
constexpr double kFineStep = 2e-3;     // s, around a fall
constexpr double kCoarseRows = 900.0;  // of a thinned record
constexpr std::size_t kFewestAirRows = 20;
constexpr double kAirBefore = 0.5e-3;  // m
constexpr double kAirAfter = 2e-3;     // m: longer, because tissue sticks to the needle
constexpr double kAirTrend = 10.0;     // 1/m: change of the force over its range
constexpr double kAirMatters = 0.02;   // of the range of force
constexpr double kFineBefore = 30e-3;  // s
constexpr double kFineAfter = 150e-3;  // s

void require_not_saturated(const NeedleRecord& record, const std::string& where) {
  constexpr std::size_t kMost = 8;     // depths, of equal force
  constexpr double kFlickers = 0.001;  // of the force
  const double most = *std::max_element(record.force.begin(), record.force.end());
  std::size_t equal = 0;
  for (std::size_t i = 1; i < record.size(); ++i) {
    if (record.force[i] < (1.0 - kFlickers) * most) {
      equal = 0;
    } else if (record.depth[i] != record.depth[i - 1]) {  // a sensor of depth repeats its values
      ++equal;
    }
    if (equal < kMost) continue;
    throw InputError(fmt::format(
        "{}: force_N is at most {} N, at {} depths one after another: is that the sensor's limit? The "
        "puncture's force is not in the record then",
        where, brief(most), kMost));
  }
}

/// What the sensor reads in the air.
struct AirReading {
  double force = 0.0;  // N, mean
  double time = 0.0;   // s, mean
  double rows = 0.0;
};

/// The reading over the first or last `way` [m] of a record's motion; none where the force changes along it,
/// as in the tissue or where the tissue still sticks to the needle.
std::optional<AirReading> read_air(const NeedleRecord& record, bool at_end, double way, double range) {
  const std::size_t most = record.size();
  const auto row_of = [&](std::size_t i) { return at_end ? most - 1 - i : i; };
  std::size_t rows = 0;
  while (rows < most && std::abs(record.depth[row_of(rows)] - record.depth[row_of(0)]) < way) ++rows;
  if (rows < kFewestAirRows || rows == most) return std::nullopt;
  const auto mean_of = [&](const std::vector<double>& values) {
    double sum = 0.0;
    for (std::size_t i = 0; i < rows; ++i) sum += values[row_of(i)];
    return sum / static_cast<double>(rows);
  };
  const AirReading air{mean_of(record.force), mean_of(record.time), static_cast<double>(rows)};
  const double depth = mean_of(record.depth);
  double along = 0.0;  // sums of squares and products about the means
  double both = 0.0;
  double across = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    const double z = record.depth[row_of(i)] - depth;
    const double f = record.force[row_of(i)] - air.force;
    along += z * z;
    both += z * f;
    across += f * f;
  }
  const double slope = both / along;
  const double error =
      std::sqrt(std::max(0.0, across / along - slope * slope) / static_cast<double>(rows - 2));
  const bool changes = std::abs(slope) > 3.0 * error + kAirTrend * range;
  return changes ? std::nullopt : std::optional(air);
}

/// Subtracts what a sensor that was not tared, or drifts, reads before the contact and after the withdrawal.
void subtract_air(Insertion& insertion, const std::string& where) {
  NeedleRecord& all = insertion.all;
  const double matters = kAirMatters * insertion.range;
  const std::optional<AirReading> before = read_air(all, false, kAirBefore, insertion.range);
  if (!before) {
    if (std::abs(all.force.front()) < matters) return;
    insertion.notes.push_back(fmt::format(
        "{}: begins at {} N and shows no rows before the contact: does it begin in the tissue, or "
        "is the sensor not tared? Start 1 mm above",
        where, brief(all.force.front())));
    return;
  }
  std::optional<AirReading> after;
  if (all.depth.back() < all.depth.front() + kAirBefore)
    after = read_air(all, true, kAirAfter, insertion.range);
  if (after && after->force < before->force) {
    // Tissue that sticks to the needle pulls it, as much as a press as deep as the needle is above its start.
    const double mirrored = 2.0 * all.depth.front() - all.depth.back();
    const auto row =
        std::find_if(all.depth.begin(), all.depth.end(), [=](double z) { return z >= mirrored; });
    const double press = all.force[static_cast<std::size_t>(row - all.depth.begin())] - before->force;
    if (press < before->force - after->force) after.reset();
  }
  const double drift = after ? after->force - before->force : 0.0;
  insertion.air = before->force;
  insertion.air_rows = before->rows;
  if (std::abs(before->force) < matters && std::abs(drift) < matters) return;
  insertion.air = 0.0;
  insertion.drift = drift;
  const double slope = after ? drift / (after->time - before->time) : 0.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    all.force[i] -= before->force + slope * (all.time[i] - before->time);
  insertion.notes.push_back(fmt::format(
      "{}: the sensor reads {} N before the contact{}: subtracted; tare it before the needle goes in", where,
      brief(before->force), after ? fmt::format(", {} N after the withdrawal", brief(after->force)) : ""));
}

/// The falls of the force until the turn, the largest first.
std::vector<Fall> falls_of(const NeedleRecord& record, std::size_t turn, double range) {
  const double noise = noise_of_rows(record.force);
  std::vector<double> sums = {0.0};
  for (const double force : record.force) sums.push_back(sums.back() + force);
  const auto row_at = [&record](double time) {
    return static_cast<std::size_t>(std::lower_bound(record.time.begin(), record.time.end(), time) -
                                    record.time.begin());
  };
  const auto mean_of = [&sums](std::size_t from, std::size_t to) {
    return (sums[to] - sums[from]) / static_cast<double>(to - from);
  };
  std::vector<Fall> found;
  for (std::size_t i = 1; i < turn; ++i) {
    const std::size_t first = std::min(i, row_at(record.time[i] - kBefore));
    const std::size_t after = std::max(i + 1, row_at(record.time[i] + kFallen));
    const std::size_t end = std::max(after + 1, row_at(record.time[i] + kFallen + kBefore));
    if (end > turn) break;
    const double fall = mean_of(first, i + 1) - mean_of(after, end);
    const double error =
        noise * std::sqrt(1.0 / static_cast<double>(i + 1 - first) + 1.0 / static_cast<double>(end - after));
    if (fall > std::max(kFallErrors * error, kLeastFall * range)) found.push_back({record.time[i], fall});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Fall& a, const Fall& b) { return a.force > b.force; });
  std::vector<Fall> falls;
  for (const Fall& one : found) {
    const bool near = std::any_of(falls.begin(), falls.end(), [&one](const Fall& other) {
      return std::abs(one.time - other.time) < kApart;
    });
    if (!near && falls.size() < kMostFalls) falls.push_back(one);
  }
  return falls;
}

/// Warns where the force rises so steeply before a fall that its mean there is not the puncture's force.
void question_speed(Insertion& insertion, const std::string& where) {
  constexpr double kSteep = 0.025;  // of the range of force, within kBefore
  const NeedleRecord& all = insertion.all;
  const auto row_at = [&all](double time) {
    return static_cast<std::size_t>(std::lower_bound(all.time.begin(), all.time.end(), time) -
                                    all.time.begin());
  };
  double steepest = 0.0;  // N within kBefore
  double speed = 0.0;     // m/s there
  for (const Fall& fall : insertion.falls) {
    const std::size_t first = row_at(fall.time - 2.0 * kBefore);
    const std::size_t middle = row_at(fall.time - kBefore);
    const std::size_t end = row_at(fall.time);
    if (first == middle || middle == end) continue;
    const std::span<const double> force(all.force);
    const double rise =
        mean(force.subspan(middle, end - middle)) - mean(force.subspan(first, middle - first));
    if (rise <= steepest) continue;
    steepest = rise;
    speed = (all.depth[end] - all.depth[first]) / (all.time[end] - all.time[first]);
  }
  const double share = steepest / insertion.range;
  if (share <= kSteep) return;
  insertion.notes.push_back(fmt::format(
      "{}: the force rises by {} of its range in {} ms before a puncture, so punctures come out too low, and "
      "outside their intervals: insert at {} mm/s, not {}",
      where, percent(share, 0), 1e3 * kBefore, brief(speed * kSteep / share / kMillimetre, 1),
      brief(speed / kMillimetre, 2)));
}

/// Means of neighbouring rows: few, but those around a fall.
NeedleRecord thinned_around(const NeedleRecord& record, const std::vector<Fall>& falls) {
  const double coarse = std::max(kFineStep, (record.time.back() - record.time.front()) / kCoarseRows);
  const auto step_at = [&](double time) {
    double step = coarse;
    for (const Fall& fall : falls) {
      const double before = fall.time - kFineBefore - time;  // a coarse row ends where fine ones begin
      if (time < fall.time + kFineAfter) step = std::min(step, std::max(before, kFineStep));
    }
    return step;
  };
  NeedleRecord few;
  few.name = record.name;
  for (std::size_t i = 0; i < record.size();) {
    double time = 0.0;
    double depth = 0.0;
    double force = 0.0;
    const std::size_t from = i;
    const double end = record.time[from] + 0.999 * step_at(record.time[from]);
    for (; i < record.size() && (i == from || record.time[i] < end); ++i) {
      time += record.time[i];
      depth += record.depth[i];
      force += record.force[i];
    }
    const auto rows = static_cast<double>(i - from);
    few.time.push_back(time / rows);
    few.depth.push_back(depth / rows);
    few.force.push_back(force / rows);
    few.rows.push_back(rows);
  }
  return few;
}

/// Rows are missing while the needle goes in, perhaps a puncture.
void require_no_gap(const Insertion& insertion, const std::string& where) {
  const std::vector<double>& time = insertion.all.time;
  for (std::size_t i = 1; i <= insertion.turn; ++i) {
    if (time[i] - time[i - 1] <= kSlowestRows) continue;
    throw InputError(fmt::format(
        "{}: time_s: no rows for {} s after {} s, while the needle goes in; must be at most {} s: a puncture "
        "there would be lost",
        where, brief(time[i] - time[i - 1], 3), brief(time[i - 1], 4), kSlowestRows));
  }
}

/// The parts of a record: in, hold, out. @throws InputError for several insertions
void find_phases(Insertion& insertion, const std::string& where) {
  const NeedleRecord& all = insertion.all;
  const double most = *std::max_element(all.depth.begin(), all.depth.end());
  const double held = most - kTurned * insertion.deepest;
  const auto first = std::find_if(all.depth.begin(), all.depth.end(), [=](double z) { return z >= held; });
  const auto last = std::find_if(all.depth.rbegin(), all.depth.rend(), [=](double z) { return z >= held; });
  insertion.turn = static_cast<std::size_t>(first - all.depth.begin());
  const auto left = static_cast<std::size_t>(all.depth.rend() - last) - 1;
  insertion.hold = all.time[left] - all.time[insertion.turn];
  const auto begin = all.depth.begin();
  const double between = *std::min_element(begin + static_cast<std::ptrdiff_t>(insertion.turn),
                                           begin + static_cast<std::ptrdiff_t>(left) + 1);
  if (most - between > kWithdrawn * insertion.deepest) {
    throw InputError(
        where + ": the needle goes in more than once: give each insertion its own name in a column specimen");
  }
  const double end =
      *std::min_element(all.depth.begin() + static_cast<std::ptrdiff_t>(left), all.depth.end());
  insertion.withdrawn = most - end > kWithdrawn * insertion.deepest;
}

}  // namespace

Insertion insertion_of(Specimen specimen, const std::string& where) {
  if (specimen.time.empty()) {
    throw InputError(where + ": time_s: missing, a needle's record needs it: a puncture is a matter of time");
  }
  if (specimen.size() < kFewestNeedleRows) {
    throw InputError(
        fmt::format("{}: has {} rows, must have at least {}", where, specimen.size(), kFewestNeedleRows));
  }
  const Ranges ranges = ranges_of(specimen);
  require_plausible(specimen, where);
  Insertion made;
  for (const std::string& question : unit_questions(specimen)) made.notes.push_back(where + ": " + question);
  made.all = {specimen.name,
              std::move(specimen.time),
              std::move(specimen.displacement),
              std::move(specimen.force),
              {}};
  const NeedleRecord& all = made.all;
  std::vector<double> steps;
  for (std::size_t i = 1; i < all.size(); ++i) steps.push_back(all.time[i] - all.time[i - 1]);
  if (const double step = median(steps); step > kSlowestRows) {
    throw InputError(
        fmt::format("{}: time_s: the rows are {} s apart, must be at most {} s: a puncture takes "
                    "about 0.04 s",
                    where, brief(step, 3), kSlowestRows));
  }
  require_not_saturated(all, where);
  made.range = ranges.force;
  made.deepest = ranges.displacement;
  find_phases(made, where);
  require_no_gap(made, where);
  subtract_air(made, where);
  const double in = mean(std::span(all.force).first(std::max<std::size_t>(1, made.turn)));
  if (made.turn < 10 || !(*std::max_element(all.force.begin(), all.force.end()) > 0.0) || in < 0.0) {
    throw InputError(where + (made.turn < 10 ? ": displacement_mm begins at its largest: must rise while the "
                                               "needle goes in"
                                             : ": force_N must be positive where the needle goes in"));
  }
  made.falls = falls_of(all, made.turn, made.range);
  if (made.falls.empty()) {
    throw InputError(fmt::format(
        "{}: force_N falls nowhere by {} of its range within {} s while the needle goes in: it has punctured "
        "nothing, or the noise hides it. Fit a press without --needle",
        where, percent(kLeastFall, 0), kFallen));
  }
  question_speed(made, where);
  made.thinned = thinned_around(all, made.falls);
  return made;
}

std::vector<Insertion> read_insertions(const std::filesystem::path& file) {
  std::vector<Insertion> all;
  std::vector<Specimen> rows = read_rows(file);
  for (Specimen& specimen : rows) {
    const std::string where = rows.size() == 1 ? to_text(file) : to_text(file) + ": " + specimen.name;
    all.push_back(insertion_of(std::move(specimen), where));
  }
  return all;
}

}  // namespace palpate::identify
