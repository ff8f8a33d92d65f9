#include "fit/identify/plausible_specimen.h"

#include <algorithm>
#include <cmath>
#include <vector>

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

void require_seconds(Specimen& s, const std::string& where) {
  if (s.time.size() < 2) return;
  const double start = s.time.front();
  if (const std::string question = unix_time_question(start); !question.empty()) {
    throw InputError(fmt::format("{}: time_s = {}: {}", where, shortest(start), question));
  }
  std::vector<double> steps;
  RowTimes times;
  for (std::size_t i = 1; i < s.time.size(); ++i) {
    steps.push_back(s.time[i] - s.time[i - 1]);
    const double moved = std::abs(s.displacement[i] - s.displacement[i - 1]);
    times.fastest = std::max(times.fastest, moved / steps.back());
  }
  times.median_step = median(steps);
  if (const std::string question = slow_rows_question(times, kSpeedRange.possible.low); !question.empty()) {
    throw InputError(fmt::format(
        "{}: time_s: the rows are {:.3g} s apart, displacement_mm changes by at most {:.3g} mm/s{}", where,
        times.median_step, times.fastest / kMillimetre, question));
  }
  if (std::abs(start) <= kLongestTimes) return;
  for (double& time : s.time) time -= start;
}

}  // namespace

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
