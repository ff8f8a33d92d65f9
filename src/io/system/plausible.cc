#include "io/system/plausible.h"

#include <vector>

#include "core/base/text.h"

namespace palpate {

std::string in_unit(const PlausibleRange& range, double value) {
  constexpr int kDigits = 6;
  return brief(value / range.unit.si, kDigits) + " " + std::string(range.unit.name);
}

std::string unit_question(const PlausibleRange& range, double value) {
  for (const double factor : {1e-3, 1e3, 1e-2, 1e2, 25.4e-3, 1.0 / 25.4e-3, 1e-6, 1e6}) {
    if (!range.usual.contains(value * factor)) continue;
    return ": is its unit right? (" + shortest(factor < 1.0 ? 1.0 / factor : factor) + " times " +
           (factor < 1.0 ? "smaller" : "larger") + " it would be " +
           brief(value * factor / range.unit.si, 3) + " " + std::string(range.unit.name) + ")";
  }
  return ": is its unit right?";
}

std::string column_question(const PlausibleRange& range, double value, std::string_view column,
                            double column_unit) {
  constexpr double kLike = 10.0;  // times: a unit that differs more from the first is left out
  std::vector<std::string> units;
  std::vector<std::string> values;
  double first = 0.0;  // [SI]
  for (const NamedUnit& unit : range.others) {
    const double other = value / column_unit * unit.si;
    if (unit.si == column_unit || !range.usual.contains(other)) continue;
    if (!units.empty() && !(unit.si < kLike * first && first < kLike * unit.si)) continue;
    if (units.empty()) first = unit.si;
    units.emplace_back(unit.name);
    values.push_back(brief(other / range.unit.si, 3));
  }
  if (units.empty()) return {};
  return ": is " + std::string(column) + " in " + joined(units, " or ") + "? (it would be " +
         joined(values, " or ") + " " + std::string(range.unit.name) + ")";
}

std::string unix_time_question(double first_time) {
  constexpr double kThisCentury = 1e11;  // s since 1970: the year 5138
  if (!(first_time >= kThisCentury)) return {};
  const double seconds_at_most = 1e10;  // the year 2286
  for (const NamedUnit& unit : kTimeUnits) {
    if (first_time * unit.si >= seconds_at_most) continue;
    return "must be in seconds: is time_s in " + std::string(unit.name) + " since 1970?";
  }
  return "must be in seconds";
}

std::string slow_rows_question(const RowTimes& rows, double slowest) {
  constexpr double kShortest = 1.0;  // s, between two rows
  if (!(rows.median_step >= kShortest && rows.fastest < slowest)) return {};
  for (const NamedUnit& unit : kTimeUnits) {
    const double speed = rows.fastest / unit.si;
    if (!kSpeedRange.usual.contains(speed)) continue;
    return ": is time_s in " + std::string(unit.name) + "? (the motion would reach " +
           brief(speed / kSpeedRange.unit.si, 3) + " mm/s)";
  }
  return ": is time_s in seconds?";
}

std::string fast_rows_question(const RowTimes& rows) {
  if (rows.fastest <= kSpeedRange.usual.high) return {};
  return ": is time_s in hours or days, as Excel counts?";
}

}  // namespace palpate
