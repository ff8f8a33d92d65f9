#include "io/system/csv_table.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate {
namespace {

constexpr std::size_t kLongestLine = std::size_t{64} << 10U;

/// "a, b and c"
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
    text += names[i];
  }
  return text;
}

std::string required_names(const std::vector<CsvColumn>& columns) {
  std::vector<std::string> names;
  for (const CsvColumn& column : columns) {
    if (column.required) names.push_back(column.name);
  }
  return listed(names);
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file, std::vector<CsvColumn> columns, double largest)
    : file_(to_text(file)),
      in_(file, kCsvInput),
      columns_(std::move(columns)),
      largest_(largest),
      buffer_(kLongestLine, '\0'),
      cell_of_(columns_.size(), kAbsent),
      numbers_(columns_.size(), 0.0) {
  if (!next_line()) throw InputError(file_ + ": is empty, must have a header and rows");
  read_header();
}

bool CsvTable::next_row() {
  if (!next_line()) {
    if (!has_rows_) throw InputError(file_ + ": has no rows after the header");
    return false;
  }
  has_rows_ = true;
  split();
  if (cells_.size() != header_cells_) {
    const bool decimal_comma = cells_.size() == 2 * header_cells_;
    fail("the row has " + std::to_string(cells_.size()) + " values, must have " +
         std::to_string(header_cells_) + " as the header" +
         (decimal_comma ? "; a decimal comma must be a point" : ""));
  }
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    if (!has(column)) continue;
    if (!columns_[column].is_text) {
      read_number(column);
    } else if (text(column).empty()) {
      fail(columns_[column].name + ": empty, must be a name");
    }
  }
  return true;
}

void CsvTable::fail(const std::string& what) const {
  throw InputError(file_ + ":" + std::to_string(line_number_) + ": " + what);
}

void CsvTable::fail(std::size_t column, const std::string& want) const {
  fail(columns_[column].name + " = " + shortest(number(column)) + ": " + want);
}

/// Reads the file's next line into line_, without its line end. @return false at the end of the file
bool CsvTable::take_line() {
  for (std::size_t searched = begin_;;) {
    const std::size_t newline = std::string_view(buffer_).substr(0, end_).find('\n', searched);
    if (newline != std::string_view::npos) {
      line_ = std::string_view(buffer_).substr(begin_, newline - begin_);
      begin_ = newline + 1;
      return true;
    }
    std::copy(buffer_.data() + begin_, buffer_.data() + end_, buffer_.data());
    end_ -= std::exchange(begin_, 0);
    searched = end_;
    if (end_ == buffer_.size()) {
      ++line_number_;
      fail("the line is longer than 64 KiB, is this a CSV file?");
    }
    const std::size_t count = in_.read(std::span(buffer_).subspan(end_));
    end_ += count;
    if (count > 0) continue;
    line_ = std::string_view(buffer_).substr(0, end_);
    begin_ = end_;
    return !line_.empty();
  }
}

/// Goes to the next line that is neither blank nor a comment, and trims it.
bool CsvTable::next_line() {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  for (;;) {
    if (!take_line()) return false;
    ++line_number_;
    if (line_number_ == 1 && line_.starts_with(kByteOrderMark)) line_.remove_prefix(kByteOrderMark.size());
    line_ = trimmed(line_);
    if (!line_.empty() && !line_.starts_with('#')) return true;
  }
}

void CsvTable::split() {
  cells_.clear();
  for (std::string_view rest = line_;;) {
    const std::size_t comma = rest.find(',');
    cells_.push_back(trimmed(rest.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    rest.remove_prefix(comma + 1);
  }
}

void CsvTable::read_header() {
  if (line_.find(';') != std::string_view::npos) {
    fail("semicolons separate the columns, must be commas, with decimal points in the numbers");
  }
  split();
  const std::string required = required_names(columns_);
  if (parse_number(cells_.front())) fail("the header is missing: the first line must name " + required);
  std::vector<std::string> unknown;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const auto named = std::find_if(columns_.begin(), columns_.end(),
                                    [&](const CsvColumn& column) { return column.name == cells_[i]; });
    if (named == columns_.end()) {
      unknown.push_back(excerpt(cells_[i]));
      continue;
    }
    const auto column = static_cast<std::size_t>(named - columns_.begin());
    if (has(column)) fail(columns_[column].name + ": the column appears twice, must appear once");
    cell_of_[column] = i;
  }
  header_cells_ = cells_.size();
  check_header(unknown);
}

/// @param unknown header names that are not in `columns`
void CsvTable::check_header(const std::vector<std::string>& unknown) const {
  std::vector<std::string> missing;
  std::vector<std::string> absent;
  std::vector<std::string> known;
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    known.push_back(columns_[column].name);
    if (!has(column)) absent.push_back(known.back());
    if (!has(column) && columns_[column].required) missing.push_back(known.back());
  }
  if (missing.empty() && unknown.empty()) return;
  const bool one_misspelt = !unknown.empty() && missing.size() <= 1;
  const std::string near =
      one_misspelt ? nearest_word(unknown.front(), missing.empty() ? absent : missing) : "";
  if (missing.empty() || !near.empty()) {
    fail("column \"" + unknown.front() + "\": unknown, " +
         (near.empty() ? "valid are " + listed(known) : "did you mean " + near + "?"));
  }
  fail(listed(missing) + ": missing, the header must name " + required_names(columns_) +
       (unknown.empty() ? "" : "; unknown in it: " + listed(unknown)));
}

void CsvTable::read_number(std::size_t column) {
  const std::optional<double> value = parse_number(text(column));
  if (!value || !std::isfinite(*value) || std::abs(*value) > largest_) {
    int power = 0;
    for (double size = 1.0; size < largest_ && !std::isinf(size); size *= 10.0) ++power;
    const std::string most = largest_ < 1e300 ? " up to 1e" + std::to_string(power) : "";
    fail(columns_[column].name + " = " + excerpt(text(column)) + ": must be a finite number" + most);
  }
  numbers_[column] = *value;
}

}  // namespace palpate
