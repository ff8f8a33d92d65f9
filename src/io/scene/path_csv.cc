#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
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
  constexpr const char* kByCommand =
      ", such as by (echo time_s,x_m,y_m,z_m,qx,qy,qz,qw; grep -v '^[#t]' FILE | tr -s ' \\t' ,) > path.csv";
  constexpr std::size_t kTum = 8;
  constexpr std::size_t kKitti = 12;
  constexpr std::size_t kEuroc = 17;
  // EuRoC's poses of a motion capture have as many values as TUM's, but another order and other times.
  const bool unix_ns =
      numbers && values.size() == kTum && !unix_time_question(*parse_number(values[0])).empty();
  if ((numbers && values.size() == kEuroc) || unix_ns || has("p_RS_R_x")) {
    return "; this is a trajectory of EuRoC (times in ns, quaternion w first)" + to_csv +
           ", such as by evo_traj euroc --save_as_tum, then from TUM";
  }
  if ((numbers && values.size() == kTum) || (has("tx") && has("ty") && has("qw"))) {
    return "; this is a trajectory of TUM or evo (timestamp tx ty tz qx qy qz qw)" + to_csv + kByCommand;
  }
  if (numbers && values.size() == kKitti) {
    return "; this is a trajectory of KITTI (3 x 4 matrices without times)" + to_csv +
           ", such as by evo_traj kitti --save_as_tum with the times, then from TUM";
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

/// The time of the file's first row [s]. @throws InputError for milli-, micro- or nanoseconds since 1970
double first_time(const CsvTable& table) {
  const double first = table.number(kTime);
  if (const std::string question = unix_time_question(first); !question.empty()) {
    table.fail(kTime, question);
  }
  return first;
}

/// Subtracts the start of the path's clock from the times. A log whose times count from elsewhere, such as
/// from 1970, starts at its first row; several hands start at the earliest of their first rows.
/// @return a remark; empty when the path begins as the file says
std::string count_from_start(std::vector<PathRow>& rows, std::optional<double> earliest) {
  const double first = rows.front().time;
  const double clock = earliest.value_or(first);
  const double start = clock >= 0.0 && clock <= kLatestStart ? 0.0 : clock;
  for (PathRow& row : rows) row.time -= start;
  const double rest = first - start;
  if (start == 0.0 && rest <= kLatestStart) return {};
  std::string remark = fmt::format("the path begins at {} s", shortest(first));
  if (start != 0.0) {
    remark +=
        ": its times are counted from " +
        (start == first ? "its first row" : shortest(start) + " s, the first row of another hand's path");
  }
  if (rest > kLatestStart) remark += fmt::format(": the tool rests for {:.6g} s", rest);
  return remark;
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

/// Asks for the units when the tool is faster than any hand, or the rows are far apart and it hardly moves.
/// @return the question; empty when there is none @throws InputError for a path that is too long
std::string time_unit_question(const std::vector<PathRow>& rows) {
  constexpr std::size_t kFewest = 8;  // rows of a log
  constexpr double kMoves = 1e-3;     // m, of a log in which the tool moves
  constexpr double kSlow = 2e-3;      // m/s; 2 m/s if the times are in ms
  constexpr double kFastest = 100.0;  // m/s, which a workspace_scale may make slower
  const double length = rows.back().time - rows.front().time;
  if (length > kLongestTimes) {
    throw InputError(
        fmt::format("time_s: the path is {:.3g} s long, must be at most {:.3g} s: is time_s in seconds, "
                    "without a jump?",
                    length, kLongestTimes));
  }
  if (rows.size() < 2) return {};
  std::vector<double> steps;
  RowTimes times;
  double way = 0.0;
  std::size_t fastest = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    steps.push_back(rows[i].time - rows[i - 1].time);
    const double moved = (rows[i].position - rows[i - 1].position).norm();
    way += moved;
    if (moved / steps.back() > times.fastest) {
      times.fastest = moved / steps.back();
      fastest = i;
    }
  }
  if (times.fastest > kFastest) {
    return fmt::format(
        "the tool moves at {:.3g} m/s between rows {} and {}: is time_s in days, as Excel counts, or is a "
        "row wrong?",
        times.fastest, fastest, fastest + 1);
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  times.median_step = *middle;
  const std::string question =
      slow_rows_question(times, rows.size() >= kFewest ? kSlow : kSpeedRange.usual.low);
  if (way < kMoves || question.empty()) return {};
  return fmt::format("time_s: the rows are {:.3g} s apart, the tool moves at most {:.3g} mm/s{}",
                     times.median_step, times.fastest * 1e3, question);
}

/// A question about a pause that is far longer than the rows of a log are apart: the tool moves evenly over
/// it, and a run takes as long.
std::string pause_question(const std::vector<PathRow>& rows) {
  constexpr std::size_t kFewest = 8;  // rows of a log
  constexpr double kLongest = 10.0;   // s
  constexpr double kManySteps = 100.0;
  if (rows.size() < kFewest) return {};
  std::size_t last = 1;
  for (std::size_t i = 2; i < rows.size(); ++i)
    if (rows[i].time - rows[i - 1].time > rows[last].time - rows[last - 1].time) last = i;
  const double pause = rows[last].time - rows[last - 1].time;
  const double usual = (rows.back().time - rows.front().time - pause) / static_cast<double>(rows.size() - 2);
  if (pause <= kLongest || pause <= kManySteps * usual) return {};
  return fmt::format(
      "time_s: rows {} and {} are {:.4g} s apart, the others {:.3g} s: are these two recordings? "
      "The tool moves evenly between them",
      last, last + 1, pause, usual);
}

}  // namespace

double first_path_time(const std::filesystem::path& file) {
  CsvTable table = open_path(file);
  (void)table.next_row();
  return first_time(table);
}

ToolPath read_tool_path(const std::filesystem::path& file, PathInterpolation interpolation,
                        std::vector<std::string>* remarks, std::optional<double> earliest) {
  CsvTable table = open_path(file);
  const bool turns = has_rotations(table);
  std::vector<PathRow> rows;
  while (table.next_row()) {
    PathRow row;
    row.time = rows.empty() ? first_time(table) : table.number(kTime);
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
    if (!rows.empty() && row.time <= rows.back().time) {
      table.fail(kTime, "must be later than the row before, " + shortest(rows.back().time));
    }
    if (!rows.empty() && !std::isfinite(row.time - rows.front().time)) {
      table.fail(kTime,
                 "the path's length must be a finite number, it begins at " + shortest(rows.front().time));
    }
    rows.push_back(row);
  }
  try {
    for (const std::string& remark :
         {time_unit_question(rows), pause_question(rows), count_from_start(rows, earliest)}) {
      if (remarks != nullptr && !remark.empty()) remarks->push_back(to_text(file) + ": " + remark);
    }
    return ToolPath(std::move(rows), table.has(kGripper), interpolation);
  } catch (const InputError& error) {
    throw InputError(to_text(file) + ": " + error.what());
  }
}

}  // namespace palpate::scene
