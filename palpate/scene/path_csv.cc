#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "palpate/base/error.h"
#include "palpate/base/text.h"
#include "palpate/scene/tool_path.h"

namespace palpate::scene {
namespace {

enum Column : std::size_t { kTime, kX, kY, kZ, kQw, kQx, kQy, kQz, kGripper, kColumns };

const std::array<std::string, kColumns> kNames = {"time_s", "x_m", "y_m", "z_m",    "qw",
                                                  "qx",     "qy",  "qz",  "gripper"};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

/// Cell text fit for a message: short, printable.
std::string shown(std::string_view cell) {
  constexpr std::size_t kLongest = 40;
  return one_line(std::string(cell.substr(0, kLongest))) + (cell.size() > kLongest ? "..." : "");
}

/// Reads one path file line by line; every error is FILE:LINE: column = value: what would be right.
class PathReader final {
 public:
  explicit PathReader(std::string name) : name_(std::move(name)) {}

  void read_header(std::string_view line) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
    for (const std::string_view cell : split(line)) {
      const auto known = std::find(kNames.begin(), kNames.end(), cell);
      if (known == kNames.end()) fail_unknown(cell);
      const auto column = static_cast<std::size_t>(known - kNames.begin());
      if (has(column)) fail(kNames[column] + ": stands twice, must stand once");
      columns_.push_back(column);
    }
    for (const std::size_t column : {kTime, kX, kY, kZ}) {
      if (!has(column)) fail(kNames[column] + ": missing, the header must name time_s, x_m, y_m and z_m");
    }
    const bool any_turn = has(kQw) || has(kQx) || has(kQy) || has(kQz);
    for (const std::size_t column : {kQw, kQx, kQy, kQz}) {
      if (any_turn && !has(column)) fail(kNames[column] + ": missing, must be all of qw, qx, qy, qz or none");
    }
    turns_ = any_turn;
  }

  void read_row(std::string_view line) {
    const std::vector<std::string_view> cells = split(line);
    if (cells.size() != columns_.size()) {
      fail("the row has " + std::to_string(cells.size()) + " values, must have " +
           std::to_string(columns_.size()) + " as the header");
    }
    std::array<double, kColumns> values{};
    for (std::size_t i = 0; i < cells.size(); ++i) values[columns_[i]] = number(columns_[i], cells[i]);
    PathRow row;
    row.time = values[kTime];
    row.position = {values[kX], values[kY], values[kZ]};
    if (turns_) row.orientation = unit(Quat(values[kQw], values[kQx], values[kQy], values[kQz]));
    row.gripper = values[kGripper];
    if (row.gripper < 0.0 || row.gripper > 1.0) {
      fail("gripper = " + shortest(row.gripper) + ": must be 0 (closed) to 1 (open)");
    }
    if (!rows_.empty() && row.time <= rows_.back().time) {
      fail("time_s = " + shortest(row.time) + ": must be later than the row before, " +
           shortest(rows_.back().time));
    }
    if (!rows_.empty() && !std::isfinite(row.time - rows_.front().time)) {
      fail("time_s = " + shortest(row.time) + ": the path's length must be a finite number, it begins at " +
           shortest(rows_.front().time));
    }
    rows_.push_back(row);
  }

  [[nodiscard]] bool has_header() const { return !columns_.empty(); }
  void next_line() { ++line_; }

  ToolPath path() {
    if (rows_.empty()) throw InputError(name_ + ": has no rows, must have a header and at least one row");
    return ToolPath(std::move(rows_), has(kGripper));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(name_ + ":" + std::to_string(line_) + ": " + what);
  }

 private:
  [[nodiscard]] bool has(std::size_t column) const {
    return std::find(columns_.begin(), columns_.end(), column) != columns_.end();
  }

  [[noreturn]] void fail_unknown(std::string_view cell) const {
    const std::string near = nearest_word(cell, kNames);
    fail("column \"" + shown(cell) + "\": unknown, " +
         (near.empty() ? "known are time_s, x_m, y_m, z_m, qw, qx, qy, qz and gripper"
                       : "did you mean " + near + "?"));
  }

  [[nodiscard]] double number(std::size_t column, std::string_view cell) const {
    double value = 0.0;
    std::string_view digits = cell;
    if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value)) {
      fail(kNames[column] + " = " + shown(cell) + ": must be a finite number");
    }
    return value;
  }

  [[nodiscard]] Quat unit(const Quat& q) const {
    constexpr double kShortest = 1e-6;  // below: no direction left to speak of
    const double norm = q.norm();
    if (std::isfinite(norm) && norm > kShortest) {
      return {q.w() / norm, q.x() / norm, q.y() / norm, q.z() / norm};
    }
    fail("qw,qx,qy,qz = " + shortest(q.w()) + "," + shortest(q.x()) + "," + shortest(q.y()) + "," +
         shortest(q.z()) + ": must be a rotation, not of length " + shortest(norm));
  }

  std::string name_;
  std::size_t line_ = 0;
  std::vector<std::size_t> columns_;  // which column each cell of a row is
  bool turns_ = false;
  std::vector<PathRow> rows_;
};

}  // namespace

ToolPath read_tool_path(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code status;
  if (!std::filesystem::exists(file, status)) throw InputError(name + ": there is no such file");
  if (std::filesystem::is_directory(file, status))
    throw InputError(name + ": is a folder, must be a CSV file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(name + ": cannot be read");
  PathReader reader(name);
  bool blank_seen = false;
  for (std::string line; std::getline(in, line);) {
    reader.next_line();
    if (trimmed(line).empty()) {
      blank_seen = true;
      continue;
    }
    if (!reader.has_header()) {
      if (blank_seen) reader.fail("a blank line stands before the header, must be the header");
      reader.read_header(line);
      continue;
    }
    if (blank_seen) reader.fail("a blank line stands before this row, must be only at the file's end");
    reader.read_row(line);
  }
  if (in.bad()) throw InputError(name + ": cannot be read to its end");
  return reader.path();
}

}  // namespace palpate::scene
