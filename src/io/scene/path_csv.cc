#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/haptics/simulation.h"
#include "io/system/csv_table.h"
#include "io/system/input_file.h"
#include "io/system/path_text.h"
#include "io/system/plausible.h"
#include "palpate/error.h"
#include "palpate/tool_path.h"

namespace palpate::scene {
namespace {

enum Column : std::size_t { kTime, kX, kY, kZ, kQw, kQx, kQy, kQz, kGripper, kButtons };

constexpr double kAllButtons = 4294967295.0;  // 32 bits

const std::vector<CsvColumn> kColumns = {{"time_s"},         {"x_m"},           {"y_m"},       {"z_m"},
                                         {"qw", false},      {"qx", false},     {"qy", false}, {"qz", false},
                                         {"gripper", false}, {"buttons", false}};

/// Whether the path has rotations: all four components of a quaternion.
bool has_rotations(const CsvTable& table) {
  const bool any = table.has(kQw) || table.has(kQx) || table.has(kQy) || table.has(kQz);
  for (const std::size_t column : {kQw, kQx, kQy, kQz}) {
    if (any && !table.has(column)) {
      table.fail(kColumns[column].name + ": missing, must be all of qw, qx, qy, qz or none");
    }
  }
  return any;
}

Quat rotation(const CsvTable& table) {
  constexpr double kShortest = 1e-6;  // a shorter quaternion has no usable direction
  const Quat q(table.number(kQw), table.number(kQx), table.number(kQy), table.number(kQz));
  const double norm = q.norm();
  if (std::isfinite(norm) && norm > kShortest) {
    return {q.w() / norm, q.x() / norm, q.y() / norm, q.z() / norm};
  }
  table.fail(fmt::format("qw,qx,qy,qz = {},{},{},{}: must be a rotation, not of length {}", shortest(q.w()),
                         shortest(q.x()), shortest(q.y()), shortest(q.z()), shortest(norm)));
}

/// The first line that is neither blank nor a comment, within the first 64 KiB; else the last of these.
std::string first_line(const std::filesystem::path& file) {
  std::string start(std::size_t{64} << 10U, '\0');
  InputFile input(file, kCsvInput);
  start.resize(input.read(std::span(start)));
  std::string_view line;
  for (std::string_view rest = start; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    line = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (!line.empty() && !line.starts_with('#')) break;
  }
  return std::string(line);
}

/// The values of a line between blanks, commas or semicolons.
std::vector<std::string_view> values_of(std::string_view line) {
  constexpr std::string_view kBetween = " \t,;";
  std::vector<std::string_view> values;
  for (std::size_t from = line.find_first_not_of(kBetween); from != std::string_view::npos;) {
    const std::size_t to = std::min(line.find_first_of(kBetween, from), line.size());
    values.push_back(line.substr(from, to - from));
    from = line.find_first_not_of(kBetween, to);
  }
  return values;
}

/// Names the format of a trajectory that other programs write, and how to convert it; empty for any other
/// file.
std::string known_trajectory(const std::filesystem::path& file) {
  const std::string line = first_line(file);
  const std::vector<std::string_view> values = values_of(line);
  const bool numbers = std::all_of(values.begin(), values.end(),
                                   [](std::string_view value) { return parse_number(value).has_value(); });
  const auto has = [&line](std::string_view name) { return line.find(name) != std::string::npos; };
  const std::string to_csv =
      ": write it as CSV with the header time_s,x_m,y_m,z_m,qx,qy,qz,qw (metres, seconds)";
  const std::string by_command = fmt::format(
      ", such as by (echo time_s,x_m,y_m,z_m,qx,qy,qz,qw; grep -v '^[#t]' {} | tr -s ' \\t' ,) > path.csv",
      excerpt(to_text(file)));
  constexpr std::size_t kTum = 8;
  constexpr std::size_t kKitti = 12;
  constexpr std::size_t kEuroc = 17;
  if ((numbers && values.size() == kTum) || (has("tx") && has("ty") && has("qw"))) {
    return "; this is a trajectory of TUM or evo (timestamp tx ty tz qx qy qz qw)" + to_csv + by_command;
  }
  if (numbers && values.size() == kKitti) {
    return "; this is a trajectory of KITTI (3 x 4 matrices without times)" + to_csv +
           ", such as by evo_traj kitti --save_as_tum with the times, then from TUM";
  }
  if ((numbers && values.size() == kEuroc) || has("p_RS_R_x")) {
    return "; this is a trajectory of EuRoC (times in ns, quaternion w first)" + to_csv +
           ", such as by evo_traj euroc --save_as_tum, then from TUM";
  }
  if (has("field.")) {
    return "; this is a topic of ROS as rostopic echo -p writes it (times in ns)" + to_csv;
  }
  return {};
}

CsvTable open_path(const std::filesystem::path& file) {
  try {
    return {file, kColumns};
  } catch (const InputError& error) {
    const std::string known = known_trajectory(file);
    if (known.empty()) throw;
    throw InputError(error.what() + known);
  }
}

/// A log whose times count from elsewhere, such as from 1970, begins at its first row. @return the time of
/// the path's start [s]
double start_of(const CsvTable& table, const std::filesystem::path& file, std::vector<std::string>* remarks) {
  const double first = table.number(kTime);
  if (const std::string question = unix_time_question(first); !question.empty()) {
    table.fail(kTime, question);
  }
  if (first >= 0.0 && first <= kLatestStart) return 0.0;
  if (remarks != nullptr) {
    remarks->push_back(fmt::format("{}: the path begins at {} s: its times are counted from its first row",
                                   to_text(file), shortest(first)));
  }
  return first;
}

/// @throws InputError when a position is out of reach, such as one in mm
void require_within_reach(const CsvTable& table, const Vec3& position) {
  for (const std::size_t column : {kX, kY, kZ}) {
    const double value = position[static_cast<Eigen::Index>(column - kX)];
    if (std::abs(value) <= haptics::kFarthest) continue;
    table.fail(column,
               fmt::format("must be within {} m{}", shortest(haptics::kFarthest),
                           column_question(kOrganDistance, std::abs(value), kColumns[column].name, 1.0)));
  }
}

/// Asks for the unit of the times when the rows are far apart and the tool hardly moves. A log cannot be so;
/// a few rows that a person gave may be.
/// @throws InputError for times that cannot be in seconds
void require_seconds(const std::vector<PathRow>& rows, const std::filesystem::path& file,
                     std::vector<std::string>* remarks) {
  constexpr std::size_t kFewest = 8;     // rows of a log
  constexpr double kMoves = 1e-3;        // m, of a log in which the tool moves
  constexpr double kSlow = 2e-3;         // m/s; 2 m/s if the times are in ms
  constexpr double kLongestStep = 20.0;  // s, between rows of a log; 50 rows a second if the times are in ms
  const double length = rows.back().time - rows.front().time;
  if (length > kLongestTimes) {
    throw InputError(
        fmt::format("{}: time_s: the path is {:.3g} s long, must be at most {:.3g} s: is time_s in "
                    "seconds, without a jump?",
                    to_text(file), length, kLongestTimes));
  }
  if (rows.size() < 2) return;
  std::vector<double> steps;
  RowTimes times;
  double way = 0.0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    steps.push_back(rows[i].time - rows[i - 1].time);
    const double moved = (rows[i].position - rows[i - 1].position).norm();
    way += moved;
    times.fastest = std::max(times.fastest, moved / steps.back());
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  times.median_step = *middle;
  const bool is_log = rows.size() >= kFewest;
  const double slowest = kSpeedRange.usual.low;
  const std::string question = slow_rows_question(times, is_log ? kSlow : slowest);
  if (way < kMoves || question.empty()) return;
  const std::string what =
      fmt::format("{}: time_s: the rows are {:.3g} s apart, the tool moves at most {:.3g} mm/s{}",
                  to_text(file), times.median_step, times.fastest * 1e3, question);
  if (is_log && (times.fastest < slowest || times.median_step >= kLongestStep)) {
    throw InputError(what + "; a motion so slow needs rows less than 1 s apart");
  }
  if (remarks != nullptr) remarks->push_back(what);
}

}  // namespace

ToolPath read_tool_path(const std::filesystem::path& file, PathInterpolation interpolation,
                        std::vector<std::string>* remarks) {
  CsvTable table = open_path(file);
  const bool turns = has_rotations(table);
  std::vector<PathRow> rows;
  double start = 0.0;   // s, subtracted from the times
  double before = 0.0;  // s, time of the row before, as in the file
  while (table.next_row()) {
    PathRow row;
    const double time = table.number(kTime);
    if (rows.empty()) start = start_of(table, file, remarks);
    row.time = time - start;
    row.position = {table.number(kX), table.number(kY), table.number(kZ)};
    require_within_reach(table, row.position);
    if (turns) row.orientation = rotation(table);
    row.gripper = table.number(kGripper);
    if (row.gripper < 0.0 || row.gripper > 1.0) table.fail(kGripper, "must be 0 (closed) to 1 (open)");
    const double buttons = table.number(kButtons);
    if (!(buttons >= 0.0 && buttons <= kAllButtons && buttons == std::floor(buttons))) {
      table.fail(kButtons, "must be a whole number, the sum of 2^button over the pressed buttons");
    }
    row.buttons = static_cast<std::uint32_t>(buttons);
    if (!rows.empty() && time <= before) {
      table.fail(kTime, "must be later than the row before, " + shortest(before));
    }
    if (!std::isfinite(row.time)) {
      table.fail(kTime, "the path's length must be a finite number, it begins at " + shortest(start));
    }
    before = time;
    rows.push_back(row);
  }
  require_seconds(rows, file, remarks);
  return ToolPath(std::move(rows), table.has(kGripper), interpolation);
}

}  // namespace palpate::scene
