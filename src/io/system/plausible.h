#pragma once
#include <limits>
#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// A unit in which a file may have a quantity.
struct NamedUnit {
  std::string_view name;
  double si = 1.0;  // in SI units
};

/// What a quantity of a file can be, in SI units. Readers may refuse a number outside `possible` and question
/// one outside `usual`: most such numbers are in another unit than the file says.
struct PlausibleRange {
  struct Interval {
    double low = 0.0;
    double high = 0.0;
    [[nodiscard]] constexpr bool contains(double value) const noexcept {
      return value >= low && value <= high;
    }
  };
  Interval possible;
  Interval usual;
  NamedUnit unit;                     // in which messages give the quantity
  std::span<const NamedUnit> others;  // in which a file may have it instead
};

inline constexpr NamedUnit kLengthUnits[] = {
    {"mm", 1e-3}, {"m", 1.0}, {"cm", 1e-2}, {"um", 1e-6}, {"in", 0.0254}};
inline constexpr NamedUnit kForceUnits[] = {
    {"mN", 1e-3}, {"gf", 9.80665e-3}, {"N", 1.0}, {"uN", 1e-6}, {"kN", 1e3}};
inline constexpr NamedUnit kStiffnessUnits[] = {{"N/m", 1.0}, {"N/cm", 1e2}, {"N/mm", 1e3}};
inline constexpr NamedUnit kTimeUnits[] = {{"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};

// The table of plausible ranges.
inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();  // no upper limit
/// Largest side of an organ's bounding box.
inline constexpr PlausibleRange kOrganExtent{{5e-3, 2.0}, {20e-3, 0.5}, {"mm", 1e-3}, kLengthUnits};
/// Largest side of an instrument's bounding box.
inline constexpr PlausibleRange kToolExtent{{0.1e-3, 5.0}, {1e-3, 1.0}, {"mm", 1e-3}, kLengthUnits};
/// Distance of an instrument from the origin of its handle.
inline constexpr PlausibleRange kToolDistance{{0.0, 50.0}, {0.0, 1.0}, {"m", 1.0}, kLengthUnits};
/// Distance of an organ from the origin of the world. Tools must reach it, and their positions are within
/// 100 m of the device's origin (haptics::kFarthest).
inline constexpr PlausibleRange kOrganDistance{{0.0, 50.0}, {0.0, 2.0}, {"m", 1.0}, kLengthUnits};
/// Smallest distance of a tool path from the organ; every distance is possible.
inline constexpr PlausibleRange kPathDistance{{0.0, kNoLimit}, {0.0, 0.2}, {"m", 1.0}, kLengthUnits};
/// Depth of a press, and deformation of a layer.
inline constexpr PlausibleRange kDepthRange{{1e-9, 0.5}, {0.2e-3, 0.1}, {"mm", 1e-3}, kLengthUnits};
/// Farthest place of a displacement profile from the contact.
inline constexpr PlausibleRange kProfileReach{{0.1e-3, 2.0}, {1e-3, 0.5}, {"mm", 1e-3}, kLengthUnits};
/// Radius of an indenter or a tool's tip.
inline constexpr PlausibleRange kTipRadius{{1e-6, 1.0}, {0.5e-3, 0.1}, {"mm", 1e-3}, kLengthUnits};
/// Force of a press. The strongest device in docs/devices.md gives 20 N.
inline constexpr PlausibleRange kForceRange{{1e-9, 1e3}, {5e-3, 100.0}, {"N", 1.0}, kForceUnits};
/// Stiffness of tissue under an indenter: brain has some N/m, cartilage 1e4 N/m.
inline constexpr PlausibleRange kPlausibleStiffness{{1e-6, 5e4}, {0.5, 2e4}, {"N/m", 1.0}, kStiffnessUnits};
/// Largest speed of a moving tool; every higher speed is possible.
inline constexpr PlausibleRange kSpeedRange{{2e-6, kNoLimit}, {1e-4, 5.0}, {"mm/s", 1e-3}, {}};

/// [setup] "0.012 mm": a value [SI] in the unit of the range.
[[nodiscard]] std::string in_unit(const PlausibleRange& range, double value);

/// [setup] ": is its unit right? (1000 times smaller it would be 110 mm)", for a file that is in one unit.
/// @param value as read [SI]
[[nodiscard]] std::string unit_question(const PlausibleRange& range, double value);

/// [setup] ": is force_N in mN or gf? (it would be 2.3 or 22.6 N)", for a column; empty when no unit makes
/// the value usual.
/// @param value as read [SI] @param column its name @param column_unit in which it should be [SI]
[[nodiscard]] std::string column_question(const PlausibleRange& range, double value, std::string_view column,
                                          double column_unit);

inline constexpr double kLatestStart = 10.0;  // s: a tool path whose first row is later counts from elsewhere
inline constexpr double kLongestTimes = 1e6;  // s, from a file's first row to its last: eleven days

/// [setup] Why the time of a file's first row cannot be in seconds: it is milli-, micro- or nanoseconds since
/// 1970. Empty: it can be in seconds.
[[nodiscard]] std::string unix_time_question(double first_time);

/// What the rows of a file show about the unit of their times.
struct RowTimes {
  double median_step = 0.0;  // s, between two rows
  double fastest = 0.0;      // m/s, of the motion between two rows
};

/// [setup] ": is time_s in ms? (the motion would reach 12 mm/s)" when rows are over a second apart and the
/// fastest motion between them is slower than `slowest` [m/s]; empty otherwise.
[[nodiscard]] std::string slow_rows_question(const RowTimes& rows, double slowest);

/// [setup] ": is time_s in hours or days, as Excel counts?" when the fastest motion is faster than usual;
/// empty otherwise.
[[nodiscard]] std::string fast_rows_question(const RowTimes& rows);

}  // namespace palpate
