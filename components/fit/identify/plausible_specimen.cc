#include "fit/identify/plausible_specimen.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::identify {
namespace {

double range_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

/// 0 is left to the checks that a column changes.
void require_possible(const PlausibleRange& range, double value, const std::string& what,
                      const std::string& question) {
  if (value == 0.0 || range.possible.contains(value)) return;
  throw InputError(what + " " + in_unit(range, value) + ", " + limit_text(range, value) + question);
}

/// @param s has two times or more
RowTimes row_times(const Specimen& s) {
  std::vector<double> steps;
  RowTimes times;
  for (std::size_t i = 1; i < s.time.size(); ++i) {
    steps.push_back(s.time[i] - s.time[i - 1]);
    const double moved = std::abs(s.displacement[i] - s.displacement[i - 1]);
    times.fastest = std::max(times.fastest, moved / steps.back());
  }
  times.median_step = median(steps);
  return times;
}

std::string motion_text(const RowTimes& times) {
  return fmt::format("time_s: the rows are {:.3g} s apart, displacement_mm changes by at most {:.3g} mm/s",
                     times.median_step, times.fastest / kMillimetre);
}

void require_seconds(Specimen& s, const std::string& where) {
  if (s.time.size() < 2) return;
  const double start = s.time.front();
  if (const std::string question = unix_time_question(start); !question.empty()) {
    throw InputError(fmt::format("{}: time_s = {}: {}", where, shortest(start), question));
  }
  const RowTimes times = row_times(s);
  if (const std::string question = slow_rows_question(times, kSpeedRange.possible.low); !question.empty()) {
    throw InputError(where + ": " + motion_text(times) + question);
  }
  if (std::abs(start) <= kLongestTimes) return;
  for (double& time : s.time) time -= start;
}

/// The specimen with the sign of its force inverted.
Specimen negated(Specimen s) {
  for (double& force : s.force) force = -force;
  return s;
}

/// Rejects data that no law can be fitted to.
void require_curve(const Specimen& s, const std::string& where) {
  if (s.size() < kFewestPoints) {
    throw InputError(fmt::format(
        "{}: has {}{}{}, must have at least {}", where, s.size(), s.size() == 1 ? " row" : " rows",
        s.empty_rows > 0 ? fmt::format(" and {} of 0 mm and 0 N", s.empty_rows) : "", kFewestPoints));
  }
  const auto [low, high] = std::minmax_element(s.displacement.begin(), s.displacement.end());
  const auto [weak, strong] = std::minmax_element(s.force.begin(), s.force.end());
  if (!(*high > *low)) {
    throw InputError(fmt::format("{}: displacement_mm is {} in every row, must change", where,
                                 shortest(*low / kMillimetre)));
  }
  if (!(*strong > *weak)) {
    throw InputError(fmt::format("{}: force_N is {} in every row, must change", where, shortest(*weak)));
  }
  if (*high <= 0.0) {
    throw InputError(where +
                     ": displacement_mm is never above 0; pressing in and pulling out both count "
                     "positive, with --direction for which");
  }
  const bool flat = is_flat(s);
  if (flat ? !is_flat(negated(s)) : !(correlation(s.displacement, s.force) > 0.0)) {
    throw InputError(where +
                     ": force_N falls as displacement_mm rises; pressing in and pulling out both "
                     "count positive, with --direction for which");
  }
  if (flat) {
    throw InputError(where +
                     ": force_N does not rise out of its noise anywhere: the tool seems not to have touched");
  }
}

/// Columns of one length, of finite numbers, with increasing times: what a file's reader has checked already.
void require_columns(const Specimen& s, const std::string& where) {
  if (s.displacement.size() != s.size() || (!s.time.empty() && s.time.size() != s.size())) {
    throw InputError(where + ": displacement, force and time must have the same length");
  }
  const auto check = [&where](const char* name, const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::isfinite(values[i])) continue;
      throw InputError(fmt::format("{}: {}[{}] = {}: must be a finite number", where, name, i, values[i]));
    }
  };
  check("displacement", s.displacement);
  check("force", s.force);
  check("time", s.time);
  for (std::size_t i = 1; i < s.time.size(); ++i) {
    if (s.time[i] > s.time[i - 1]) continue;
    throw InputError(fmt::format("{}: time[{}] = {}: must be later than the one before, {}", where, i,
                                 shortest(s.time[i]), shortest(s.time[i - 1])));
  }
}

/// A step shows one depth alone. @throws InputError
void require_depths(const Specimen& s, const std::string& where) {
  constexpr double kEnd = 0.05;       // of the range of displacement
  constexpr std::size_t kFewest = 3;  // rows
  const auto [low, high] = std::minmax_element(s.displacement.begin(), s.displacement.end());
  const double end = kEnd * (*high - *low);
  const auto between =
      std::count_if(s.displacement.begin(), s.displacement.end(),
                    [from = *low + end, to = *high - end](double at) { return at > from && at < to; });
  if (static_cast<std::size_t>(between) >= kFewest) return;
  throw InputError(fmt::format(
      "{}: displacement_mm goes from {} to {} in a step, with {} rows between: must have at least {}, which "
      "show how the force grows with the depth: press more slowly, or sample faster",
      where, brief(*low / kMillimetre, 3), brief(*high / kMillimetre, 3), between, kFewest));
}

/// A question where a range is unusual; "" where it is not.
std::string unusual(const PlausibleRange& range, double value, const char* what, const char* column,
                    double unit) {
  if (range.usual.contains(value)) return "";
  return fmt::format("{} {}, usual is {} to {}{}", what, in_unit(range, value),
                     brief(range.usual.low / range.unit.si), in_unit(range, range.usual.high),
                     column_question(range, value, column, unit));
}

}  // namespace

bool is_flat(const Specimen& s) {
  const Ranges ranges = ranges_of(s);
  return flat_until(s, ranges) >= ranges.lowest_displacement + ranges.displacement;
}

std::string time_unit_question(const Specimen& specimen) {
  if (specimen.time.size() < 2) return {};
  const RowTimes times = row_times(specimen);
  const std::string slow = slow_rows_question(times, kSpeedRange.usual.low);
  const std::string question = slow.empty() ? fast_rows_question(times) : slow;
  return question.empty() ? "" : motion_text(times) + question;
}

std::string exchange_question(const Specimen& specimen) {
  constexpr double kConcave = 0.6;  // of the rise of force, over the first half of the displacement
  const Specimen sorted = by_displacement(specimen);
  const Ranges ranges = ranges_of(sorted);
  const auto mean_force = [&](double share) {
    constexpr double kWindow = 0.05;  // of the range of displacement, to each side
    double sum = 0.0;
    double rows = 0.0;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      const double at = (sorted.displacement[i] - ranges.lowest_displacement) / ranges.displacement;
      if (std::abs(at - share) > kWindow) continue;
      sum += sorted.force[i];
      rows += 1.0;
    }
    return sum / rows;  // not a number without rows, which no comparison finds
  };
  const double first = mean_force(0.0);
  if (!(mean_force(0.5) - first > kConcave * (mean_force(1.0) - first))) return {};
  return "force_N rises ever more slowly with displacement_mm, where soft tissue stiffens: are the two "
         "columns "
         "exchanged, or does the tool slip?";
}

std::vector<std::string> unit_questions(const Specimen& specimen) {
  const double depth = range_of(specimen.displacement);
  const double force = range_of(specimen.force);
  std::vector<std::string> all = {
      unusual(kDepthRange, depth, "displacement_mm changes by", "displacement_mm", kMillimetre),
      unusual(kForceRange, force, "force_N changes by", "force_N", 1.0)};
  if (all[0].empty() && all[1].empty() && depth > 0.0) {
    if (!kPlausibleStiffness.usual.contains(force / depth)) {
      all.push_back(fmt::format(
          "the range of force_N over that of displacement_mm is {}, usual is {} to {}: are force_N in N and "
          "displacement_mm in mm?",
          in_unit(kPlausibleStiffness, force / depth), brief(kPlausibleStiffness.usual.low),
          in_unit(kPlausibleStiffness, kPlausibleStiffness.usual.high)));
    }
  }
  if (specimen.tip_radius > 0.0) {
    all.push_back(unusual(kTipRadius, specimen.tip_radius, "the indenter's radius is", "indenter_radius_mm",
                          kMillimetre));
  }
  std::erase(all, std::string());
  return all;
}

void require_tip_radius(const std::string& name, double radius) {
  if (kTipRadius.possible.contains(radius)) return;
  throw InputError(fmt::format("{} {}: must be within {} and {}: is it in mm?", name,
                               shortest(radius / kMillimetre), brief(kTipRadius.possible.low / kMillimetre),
                               brief(kTipRadius.possible.high / kMillimetre)));
}

void check_specimen(Specimen& specimen, const std::string& where) {
  require_columns(specimen, where);
  if (specimen.tip_radius != 0.0) {
    require_tip_radius(where + ": the indenter's radius in mm,", specimen.tip_radius);
  }
  require_curve(specimen, where);
  require_plausible(specimen, where);
  require_depths(specimen, where);
}

std::string limit_text(const PlausibleRange& range, double value) {
  return value > range.possible.high ? "must be at most " + in_unit(range, range.possible.high)
                                     : "must be at least " + in_unit(range, range.possible.low);
}

void require_plausible(Specimen& specimen, const std::string& where) {
  const double depth = range_of(specimen.displacement);
  const double force = range_of(specimen.force);
  const std::string of_depth = column_question(kDepthRange, depth, "displacement_mm", kMillimetre);
  const std::string of_force = column_question(kForceRange, force, "force_N", 1.0);
  require_possible(kDepthRange, depth, where + ": displacement_mm changes by", of_depth);
  require_possible(kForceRange, force, where + ": force_N changes by", of_force);
  if (depth > 0.0) {
    require_possible(kPlausibleStiffness, force / depth,
                     where + ": the range of force_N over that of displacement_mm is",
                     kDepthRange.usual.contains(depth) || of_depth.empty() ? of_force : of_depth);
  }
  require_seconds(specimen, where);
}

}  // namespace palpate::identify
